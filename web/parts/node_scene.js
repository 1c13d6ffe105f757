// What the 3D view shows of the selected node close up.
import { h, html } from "../html.js";
import { lookAtSelected, setScene } from "../actions.js";
import { scene } from "../store.js";
import { Button, Chip } from "./button.js";
import { metres } from "./inputs.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {NonNullable<import("../store.js").Schemas["Scene"]["node_parts"]>[number]} Part */

const hasCloud = (/** @type {NodeDetail} */ node) => node.has_image && (node.has_depth || node.has_right) && node.cameras.length > 0;

/** What it is called, what it shows, what a node without it lacks. @type {[Part, string, string, string, (node: NodeDetail) => boolean][]} */
const PARTS = [
  ["cloud", "Cloud", "Every pixel that has depth", "depth image with a calibration", hasCloud],
  ["mesh", "Mesh", "The same as a surface", "depth image with a calibration", hasCloud],
  ["words", "Words", "Key points that have a place; words green", "key points", (node) => node.features > 0],
  ["scan", "Scan", "Its scan, coloured by what is stored of each point", "scan", (node) => Boolean(node.sensors.scan?.points)],
  ["grid", "Grid", "Its local grid on the floor", "local grid", (node) => Boolean(node.sensors.grid)],
  ["elevation", "Heights", "The highest point of each cell around it, blue to red", "depth and no scan", (node) => hasCloud(node) || Boolean(node.sensors.scan?.points)],
  ["frustum", "Camera", "Its image where the camera was", "image with a calibration", (node) => node.has_image && node.cameras.length > 0],
];

/** @param {{node: NodeDetail}} props */
export function NodeScene({ node }) {
  const now = scene.value;
  const parts = now?.node_parts ?? [];
  const turn = (/** @type {Part} */ part, /** @type {boolean} */ on) =>
    void setScene({ node_parts: on ? [...parts, part] : parts.filter((one) => one !== part) });
  return html`<div class="picture-bar node-scene" role="group" aria-label="The node in the 3D view">
    <span class="quiet small">3D</span>
    ${PARTS.map(([part, label, hint, lacking, has]) =>
      h(Chip, { key: part, label, hint: has(node) ? hint : `This node has no ${lacking}`, on: parts.includes(part) && has(node), disabled: !now || !has(node), onChange: (on) => turn(part, on) }),
    )}
    <span class="grow"></span>
    ${h(Chip, { label: "Alone", hint: "Without the map around it", on: Boolean(now?.alone), disabled: !now, onChange: (on) => void setScene({ alone: on }) })}
    ${h(Button, { id: "look", label: "Look", hint: "Bring the camera of the 3D view to this node", disabled: !now || !node.pose, onClick: () => void lookAtSelected() })}
    ${now && hasCloud(node) && (parts.includes("cloud") || parts.includes("mesh")) && h(DepthUse, { use: now.depth ?? ALL_PIXELS })}
  </div>`;
}

/** @typedef {import("../store.js").Schemas["DepthUse"]} Use */

/** @type {Required<Use>} */
const ALL_PIXELS = { every: 1, far_m: 0, edges: true };
/** @type {[NonNullable<Use["every"]>, string][]} */
const EVERY = [[1, "every pixel"], [2, "every 2nd"], [4, "every 4th"], [8, "every 8th"]];

/** Of which pixels cloud and mesh are made, the same for all nodes. @param {{use: Use}} props */
function DepthUse({ use }) {
  const change = (/** @type {Partial<Use>} */ next) => void setScene({ depth: { ...ALL_PIXELS, ...use, ...next } });
  return html`<div class="picture-bar depth-use" role="group" aria-label="Pixels of the cloud">
    <label class="chip chip-select" title="Of each row, and rows">
      <select aria-label="How many pixels" value=${String(use.every)} onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => change({ every: EVERY[currentTarget.selectedIndex][0] })}>
        ${EVERY.map(([every, label]) => html`<option key=${every} value=${String(every)}>${label}</option>`)}
      </select>
    </label>
    <label class="small quiet">up to ${metres("Farthest pixel in metres, empty for all", "all", use.far_m ?? 0, (far_m) => change({ far_m }))} m</label>
    ${h(Chip, { label: "Edges", hint: "Pixels at the edges of things, which may hang in the air behind them", on: use.edges ?? true, onChange: (edges) => change({ edges }) })}
  </div>`;
}
