// The 3D view: an iframe that stays while views come and go, layer chips above it, a legend below.
import { useEffect } from "preact/hooks";
import { h, html } from "../html.js";
import { setScene } from "../actions.js";
import { draft } from "../draft.js";
import * as text from "../format.js";
import { openMapId } from "../router.js";
import { info, scene } from "../store.js";
import { theme } from "../theme.js";
import { Chip } from "./button.js";
import { Legend } from "./legend.js";
import { SceneFrame } from "./scene_frame.js";

/** @typedef {import("../store.js").Schemas["SceneLayers"]} Layers */

/** @type {{layer: keyof Layers, label: string, hint: string}[]} */
const LAYERS = [
  { layer: "graph", label: "Graph", hint: "Nodes and links" },
  { layer: "cloud", label: "Cloud", hint: "Coloured points of the nodes" },
  { layer: "grid", label: "Grid", hint: "Occupied and free floor" },
  { layer: "model", label: "Model", hint: "The mesh or cloud that is stored with the map" },
  { layer: "odometry", label: "Odometry", hint: "The path before optimisation" },
  { layer: "truth", label: "Truth", hint: "The true path, where the source knows it" },
];
const COLOURS = ["memory", "session", "time", "weight"];

export function SceneView() {
  const map = openMapId.value;
  const other = scene.value && scene.value.dark !== (theme.value === "dark");
  useEffect(() => void (other && setScene({ dark: theme.value === "dark" })), [map, other, theme.value]);
  if (!map) return null;
  return html`<section class="scene" aria-label="3D view">
    ${h(SceneFrame, { key: map, map })}
    <div class="scene-bar" role="toolbar" aria-label="Layers">${h(LayerChips, {})}</div>
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

function LayerChips() {
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
    ${ghostChip(now)}
    <label class="chip chip-select">
      Colour
      <select
        disabled=${!now}
        value=${now?.colour ?? "memory"}
        onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) =>
          void setScene({ colour: /** @type {"memory"} */ (currentTarget.value) })}
      >
        ${COLOURS.map((name) => html`<option key=${name} value=${name}>${name}</option>`)}
      </select>
    </label>`;
}
