// The 3D view: an iframe that stays while views come and go, layer chips above it, a legend below.
import { h, html } from "../html.js";
import { setScene } from "../actions.js";
import { draft } from "../draft.js";
import * as text from "../format.js";
import { openMapId, route } from "../router.js";
import { info, scene } from "../store.js";
import { Chip } from "./button.js";
import { Colouring } from "./colouring.js";
import { Legend } from "./legend.js";
import { SceneFrame } from "./scene_frame.js";

/** @typedef {import("../store.js").Schemas["SceneLayers"]} Layers */
/** @typedef {import("../store.js").Schemas["Scene"]} Scene */

/** @type {{layer: keyof Layers, label: string, hint: string}[]} */
const LAYERS = [
  { layer: "graph", label: "Graph", hint: "Nodes and links" },
  { layer: "cloud", label: "Cloud", hint: "Coloured points of the nodes" },
  { layer: "grid", label: "Grid", hint: "Occupied and free floor" },
  { layer: "model", label: "Model", hint: "The mesh or cloud that is stored with the map" },
  { layer: "odometry", label: "Odometry", hint: "The path before optimisation" },
  { layer: "truth", label: "Truth", hint: "The true path, where the source knows it" },
];

export function SceneView() {
  const map = openMapId.value;
  if (!map) return null;
  return html`<section class="scene" aria-label="3D view">
    ${h(SceneFrame, { key: map, map })}
    <div class="scene-bar" role="toolbar" aria-label="Layers">${h(LayerChips, { map })}</div>
    ${h(Legend, {})}
  </section>`;
}

/** Ghosts that were left by a reload can be put away. @param {import("../store.js").Schemas["Scene"] | null} now */
function ghostChip(now) {
  if (now !== null && now.what_if === null && now.trial !== null) {
    return h(Chip, { label: `Trial ${now.trial} ×`, hint: "Ghosts of a trial of parameters are shown; click to hide them", on: true, onChange: () => void setScene({ trial: null }) });
  }
  if (now === null || now.what_if === null || draft.value !== null) return null;
  return h(Chip, { label: `What if ${text.short(now.what_if)} ×`, hint: "Ghosts of another LoopThr are shown; click to hide them", on: true, onChange: () => void setScene({ what_if: null }) });
}

/** The path of an optimisation stays until it is put away. @param {import("../store.js").Schemas["Scene"] | null} now */
function trialChip(now) {
  if (!now?.optimised || route.value.view === "graph") return null;
  return h(Chip, { label: "Optimised on trial ×", hint: "The dashed path of an optimisation on trial is shown; click to hide it", on: true, onChange: () => void setScene({ optimised: null }) });
}

/** @type {[Scene["grid_as"], string][]} */
const GRID_LOOKS = [
  ["plan", "plan"],
  ["frontiers", "frontiers"],
  ["probability", "probability"],
];

/** @param {{shown: Scene["grid_as"]}} props */
function GridLook({ shown }) {
  const change = (/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => void setScene({ grid_as: /** @type {Scene["grid_as"]} */ (currentTarget.value) });
  return html`<label class="chip chip-select" title="Free and occupied floor; where it borders on the unknown; or how likely each cell is occupied">
    <select aria-label="What the grid shows" value=${shown} onChange=${change}>
      ${GRID_LOOKS.map(([name, label]) => html`<option key=${name} value=${name}>${label}</option>`)}
    </select>
  </label>`;
}

/** @param {{map: string}} props */
function LayerChips({ map }) {
  const now = scene.value;
  const noTruth = info.value !== null && !info.value.has_truth;
  return html`${LAYERS.filter(({ layer }) => layer !== "model" || info.value?.has_model).map(({ layer, label, hint }) =>
      h(Chip, {
        key: layer,
        label,
        hint: layer === "truth" && noTruth ? "This map has no ground truth" : hint,
        on: Boolean(now?.layers[layer]),
        disabled: !now || (layer === "truth" && noTruth),
        onChange: (on) => void setScene({ layers: { [layer]: on } }),
      }),
    )}
    ${now?.layers.grid && h(GridLook, { shown: now.grid_as })} ${ghostChip(now)} ${trialChip(now)}
    ${h(Colouring, { key: map, map })}`;
}
