// The choice of how depth looks, the same for all nodes.
import { html } from "../html.js";
import { DEPTH_COLOURS, depthColours, farthest, nearest, secondShown, veil } from "../depth_look.js";

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
    ${metres("Nearest depth in metres", "0", nearest)}<span class="quiet small">to</span>${metres("Farthest depth in metres, empty to fit", "auto", farthest)}<span class="quiet small">m</span>
    <span class="grow"></span>
    <label class="veil small quiet" title="How much of the depth lies over the colour image">
      over colour
      <input type="range" min="0" max="1" step="0.05" aria-label="Depth over colour" value=${veil.value} onInput=${(/** @type {Changed} */ { currentTarget }) => (veil.value = Number(currentTarget.value))} />
    </label>
  </div>`;
}

/** @param {string} label @param {string} empty @param {import("@preact/signals").Signal<number>} kept */
function metres(label, empty, kept) {
  return html`<input
    class="field number"
    type="number"
    min="0"
    max="1000"
    step="0.1"
    aria-label=${label}
    title=${label}
    placeholder=${empty}
    value=${kept.value || ""}
    onChange=${(/** @type {Changed} */ { currentTarget }) => (kept.value = Math.max(0, Math.min(1000, Number(currentTarget.value) || 0)))}
  />`;
}
