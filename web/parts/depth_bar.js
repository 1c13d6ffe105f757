// The choice of how depth looks, the same for all nodes.
import { h, html } from "../html.js";
import { DEPTH_COLOURS, depthColours, farthest, nearest, secondShown, veil, withEdges } from "../depth_look.js";
import { Chip } from "./button.js";
import { metres } from "./inputs.js";

/** @typedef {{currentTarget: HTMLInputElement}} Changed */

/** @param {{seconds: string[]}} props seconds: what can be beside the colour image */
export function DepthLook({ seconds }) {
  const choice = seconds.length > 1;
  const shown = seconds.includes(secondShown.value) ? secondShown.value : seconds[0];
  return html`<div class="picture-bar depth-bar" role="group" aria-label="How depth looks">
    ${choice &&
    html`<label class="chip chip-select" title="What is beside the colour image">
      <select aria-label="Second picture" value=${shown} onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => (secondShown.value = currentTarget.value)}>
        ${seconds.map((name) => html`<option key=${name} value=${name}>${name}</option>`)}
      </select>
    </label>`}
    <label class="chip chip-select">
      ${choice ? "" : "Depth"}
      <select aria-label="Colours of depth" value=${depthColours.value} onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => (depthColours.value = currentTarget.value)}>
        ${DEPTH_COLOURS.map((name) => html`<option key=${name} value=${name}>${name}</option>`)}
      </select>
    </label>
    ${metres("Nearest depth in metres", "0", nearest.value, (value) => (nearest.value = value))}<span class="quiet small">to</span>${metres("Farthest depth in metres, empty to fit", "auto", farthest.value, (value) => (farthest.value = value))}<span class="quiet small">m</span>
    ${h(Chip, { label: "Edges", hint: "Pixels at the edges of things, which may lie between two surfaces", on: withEdges.value, onChange: (on) => (withEdges.value = on) })}
    <span class="grow"></span>
    <label class="veil small quiet" title="How much of the depth lies over the colour image">
      over colour
      <input type="range" min="0" max="1" step="0.05" aria-label="Depth over colour" value=${veil.value} onInput=${(/** @type {Changed} */ { currentTarget }) => (veil.value = Number(currentTarget.value))} />
    </label>
  </div>`;
}
