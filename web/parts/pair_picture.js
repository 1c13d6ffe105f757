// The colour images of two nodes side by side, with a line for each word that both have once.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { address } from "../api.js";
import * as text from "../format.js";
import { remembered } from "../prefs.js";
import { Chip } from "./button.js";
import { Canvas, useImage } from "./canvas.js";
import { NO_WORD, WORD, drawPoints } from "./keypoints.js";
import { GAP, drawLines } from "./matches.js";
import { keyPointAt, keyPointText } from "./pixel.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {import("../store.js").Schemas["NodeFeatures"]} NodeFeatures */
/** @typedef {import("../store.js").Schemas["SharedWords"]} SharedWords */

const showLines = remembered("pair-lines", true);
const showShared = remembered("pair-shared", true);
const showOthers = remembered("pair-others", false);

/**
 * @typedef {object} PairProps
 * @property {string} map
 * @property {NodeDetail} first
 * @property {NodeDetail} other
 * @property {NodeFeatures | null} left key points of the first
 * @property {NodeFeatures | null} right
 * @property {SharedWords} words
 */

/** @param {PairProps} props */
export function PairPicture({ map, first, other, left, right, words }) {
  const [at, setAt] = useState(/** @type {import("./canvas.js").Place | null} */ (null));
  const a = useImage(first.has_image ? address("api", "maps", map, "nodes", first.id, "image") : null);
  const b = useImage(other.has_image ? address("api", "maps", map, "nodes", other.id, "image") : null);
  const images = [first.has_image ? a.image : null, other.has_image ? b.image : null];
  if (!first.has_image && !other.has_image) return html`<div class="picture-none quiet">No colour images are stored.</div>`;
  const one = images[0] ?? images[1];
  const pointed = at && pointedWord(at, images, [left, right], words);
  return html`<div class="pair-picture">
    ${h(Canvas, {
      label: `Images of node ${first.id} (left) and node ${other.id} (right) with the words that both have`,
      aspect: 2 * (one ? one.naturalWidth / one.naturalHeight : 4 / 3),
      dependencies: [...images, left, right, words, showLines.value, showShared.value, showOthers.value, pointed?.word],
      pixels: one && 2 * one.naturalWidth + GAP,
      onPoint: setAt,
      draw: (ctx, width, height) => draw(ctx, width, height, images, left, right, words, pointed?.word ?? null),
    })}
    <p class="pixel-line quiet">
      ${pointed ? pointed.said : html`<span><b>${text.plural(words.words, "word")}</b> in both, of ${text.whole(words.of[0])} and ${text.whole(words.of[1])}${words.words > 0 && "; point at one to follow it"}</span>`}
    </p>
  </div>`;
}

/** @param {{words: SharedWords}} props */
PairPicture.Toggles = function Toggles({ words }) {
  return html`<div class="picture-bar pair-bar" role="group" aria-label="Words of both images">
    ${h(Chip, { label: `Shared ${text.whole(words.words)}`, hint: "Key points whose word the other image has too", on: showShared.value, onChange: (on) => (showShared.value = on) })}
    ${h(Chip, { label: `Lines ${text.whole(words.word.length)}`, hint: "Words that each image has once: there is no doubt which is which", on: showLines.value, onChange: (on) => (showLines.value = on) })}
    ${h(Chip, { label: "Not shared", hint: "All other key points", on: showOthers.value, onChange: (on) => (showOthers.value = on) })}
  </div>`;
};

/** @typedef {(HTMLImageElement | null)[]} Images */

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} width
 * @param {number} height
 * @param {Images} images
 * @param {NodeFeatures | null} left
 * @param {NodeFeatures | null} right
 * @param {SharedWords} words
 * @param {number | null} chosen the word under the pointer
 */
function draw(ctx, width, height, images, left, right, words, chosen) {
  const half = (width - GAP) / 2;
  images.forEach((image, k) => image && ctx.drawImage(image, k * (half + GAP), 0, half, height));
  if (!left || !right || !images[0] || !images[1]) return;
  const scales = images.map((image) => half / /** @type {HTMLImageElement} */ (image).naturalWidth);
  const sides = /** @type {[NodeFeatures, number, number, Set<number>][]} */ ([
    [left, scales[0], 0, new Set(words.shared_a)],
    [right, scales[1], half + GAP, new Set(words.shared_b)],
  ]);
  for (const [features, scale, from, shared] of sides) {
    if (showOthers.value) drawPoints(ctx, features, scale, () => NO_WORD, from, (i) => !shared.has(i));
    if (showShared.value) drawPoints(ctx, features, scale, () => WORD, from, (i) => shared.has(i));
  }
  const end = (/** @type {NodeFeatures} */ { x, y }, /** @type {number} */ i, /** @type {number} */ scale) => [(x[i] + 0.5) * scale, (y[i] + 0.5) * scale];
  const ends = words.word.map((_, k) => {
    const [[ax, ay], [bx, by]] = [end(left, words.a[k], scales[0]), end(right, words.b[k], scales[1])];
    return [ax, ay, half + GAP + bx, by];
  });
  if (showLines.value) drawLines(ctx, ends, half, { colour: WORD, width: 1, alpha: chosen === null ? 0.5 : 0.15, points: 0 });
  const line = words.word.indexOf(chosen ?? -1);
  if (line >= 0) drawLines(ctx, [ends[line]], half, { colour: "#ffffff", width: 2, alpha: 1, points: 1 });
}

/**
 * The key point under the pointer.
 * @param {import("./canvas.js").Place} place
 * @param {Images} images
 * @param {(NodeFeatures | null)[]} features
 * @param {SharedWords} words
 */
function pointedWord([x, y], images, features, words) {
  const k = x < 0.5 ? 0 : 1;
  const [image, here, there] = [images[k], features[k], features[1 - k]];
  if (!image || !here) return null;
  const i = keyPointAt(here, [image.naturalWidth, image.naturalHeight], [2 * x - k, y]);
  if (i < 0) return null;
  const word = here.word[i];
  const times = there ? there.word.filter((one) => one === word && word > 0).length : 0;
  const other = times ? html` <span>${times === 1 ? "also" : `${times} times`} in the other</span>` : html` <span class="quiet">not in the other</span>`;
  return { word: words.word.includes(word) ? word : null, said: html`<span class="pixel-parts">${keyPointText(here, i)}${other}</span>` };
}
