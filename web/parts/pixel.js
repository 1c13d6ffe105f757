// What is under the pointer: pixel, depth, point, and the key point there.
import { html } from "../html.js";
import * as text from "../format.js";
import { pointed, told } from "../pointed.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {import("../store.js").Schemas["NodeFeatures"]} NodeFeatures */

/** A key point this near to the pointer is meant, as a share of the width. */
const NEAR = 0.02;

/** A cross where the pointer is, in whichever picture of the node. @param {{node: number}} props */
export function Cross({ node }) {
  const at = pointed.value;
  if (at?.node !== node) return null;
  const [x, y] = at.place;
  return html`<i class="cross" aria-hidden="true" style=${{ left: `${100 * x}%`, top: `${100 * y}%` }}></i>`;
}

/** @param {{node: NodeDetail, features: NodeFeatures | null, quiet: string}} props quiet: what to say while nothing is pointed at */
export function PixelLine({ node, features, quiet }) {
  const at = pointed.value;
  if (at?.node !== node.id) return html`<p class="pixel-line quiet">${quiet}</p>`;
  const answer = told.value?.node === node.id ? told.value : null;
  return html`<p class="pixel-line" role="status">
    ${answer?.error && html`<span class="ink-bad clip">${answer.error}</span>`} ${answer?.pixel ? depthParts(answer.pixel, node) : !answer && placeOnly(node, at.place)}
    ${features && keyPoint(features, node, at.place)}
  </p>`;
}

/** How far apart both cameras of a pair see a point, pixels. @param {NodeDetail} node @param {import("../pointed.js").PixelDepth} pixel */
function disparityText({ cameras }, { camera, depth_m, depth_width }) {
  const { baseline_m, fx, width } = cameras[camera] ?? {};
  if (!baseline_m || !depth_m || !width || !fx) return "stereo";
  return `stereo, ${text.fixed((fx * baseline_m * depth_width) / (depth_m * width * cameras.length), 1)} px apart`;
}

/** @param {import("../pointed.js").PixelDepth} pixel @param {NodeDetail} node */
function depthParts(pixel, node) {
  const { u, v, depth_u, depth_v, depth_m, stereo, confidence, base, map, depth_width, depth_height } = pixel;
  const point = (/** @type {number[]} */ of) => of.map((value) => text.fixed(value, 2)).join(" ");
  const hint = `Pixel ${depth_u}, ${depth_v} of the depth image of ${depth_width} × ${depth_height}`;
  return html`<span class="pixel-parts">
    <span title=${hint}><span class="quiet">pixel</span> ${u === null ? `${depth_u}, ${depth_v}` : `${text.short(u)}, ${text.short(v)}`}</span>
    ${depth_m === null
      ? html`<span class="ink-warn">no depth here</span>`
      : html`<b title=${stereo ? "Worked out from the stereo pair" : "Along the optical axis, as it is stored"}>${text.fixed(depth_m, 3)} m${stereo ? ` (${disparityText(node, pixel)})` : ""}</b>`}
    ${confidence !== null && html`<span title="How sure the camera was of it, 0 to 100"><span class="quiet">confidence</span> ${confidence}</span>`}
    ${base && html`<span title="The point in the frame of the base, metres"><span class="quiet">base</span> ${point(base)}</span>`}
    ${map && html`<span title="The point in the frame of the map, metres"><span class="quiet">map</span> ${point(map)}</span>`}
  </span>`;
}

/** @param {NodeDetail} node @param {import("./canvas.js").Place} place */
function placeOnly(node, [x, y]) {
  const size = imageSize(node);
  if (!size) return null;
  const part = html`<span><span class="quiet">pixel</span> ${Math.floor(x * size[0])}, ${Math.floor(y * size[1])}</span>`;
  return html`<span class="pixel-parts">${part}${!node.has_depth && !node.has_right && html`<span class="quiet">no depth is stored</span>`}</span>`;
}

/** Of the whole colour image, by its calibrations. @param {NodeDetail} node @returns {[number, number] | null} */
export function imageSize({ cameras }) {
  if (!cameras.length || !cameras[0].width) return null;
  return [cameras.reduce((sum, { width }) => sum + width, 0), cameras[0].height];
}

/** The key point near a place, -1 for none. @param {NodeFeatures} features @param {[number, number]} size @param {import("./canvas.js").Place} place */
export function keyPointAt({ x, y }, [width, height], [px, py]) {
  let found = -1;
  let least = (NEAR * width) ** 2;
  for (let i = 0; i < x.length; i += 1) {
    const distance = (x[i] + 0.5 - px * width) ** 2 + (y[i] + 0.5 - py * height) ** 2;
    if (distance < least) [found, least] = [i, distance];
  }
  return found;
}

/** @param {NodeFeatures} features @param {NodeDetail} node @param {import("./canvas.js").Place} place */
function keyPoint(features, node, place) {
  const size = imageSize(node);
  const i = size ? keyPointAt(features, size, place) : -1;
  return i < 0 ? null : html`<span class="pixel-parts">${keyPointText(features, i)}</span>`;
}

/** @param {NodeFeatures} features @param {number} i */
export function keyPointText({ word, size, angle, depth_m }, i) {
  const name = word[i] > 0 ? html`<span class="ink-good">word ${word[i]}</span>` : html`<span class="ink-warn">no word</span>`;
  return html`<span>${name}, size ${text.short(size[i])} px${angle[i] < 0 ? "" : `, ${text.fixed(angle[i], 0)}°`}, ${depth_m[i] === null ? "no depth" : `at ${text.fixed(depth_m[i], 2)} m`}</span>`;
}
