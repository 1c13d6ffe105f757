// The choice of how depth looks, the same for all nodes.
import { html } from "../html.js";
import { DEPTH_COLOURS, SECONDS, depthColours, farthest, nearest, secondShown, veil } from "../depth_look.js";

/** @typedef {{currentTarget: HTMLInputElement}} Changed */

/** @param {{stereo: boolean}} props stereo: whether there is a right image, which can be shown in place of depth */
export function DepthLook({ stereo }) {
  return html`<div class="picture-bar depth-bar" role="group" aria-label="How depth looks">
    ${stereo &&
    html`<label class="chip chip-select" title="Beside the left image: the right one, or what is worked out of both">
      <select aria-label="Second picture" value=${secondShown.value} onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => (secondShown.value = currentTarget.value)}>
        ${SECONDS.map((name) => html`<option key=${name} value=${name}>${name}</option>`)}
      </select>
    </label>`}
    <label class="chip chip-select">
      ${stereo ? "" : "Depth"}
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
