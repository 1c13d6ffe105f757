// A node's colour image with its key points, and its depth over it where that is wanted.
import { h, html } from "../html.js";
import { address, get } from "../api.js";
import { depthAddress, veil } from "../depth_look.js";
import * as text from "../format.js";
import { remembered } from "../prefs.js";
import { Chip } from "./button.js";
import { Canvas, useImage } from "./canvas.js";
import { useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {import("../store.js").Schemas["NodeFeatures"]} NodeFeatures */
/** @typedef {(index: number) => string} Ink colour of a key point */

const shown = remembered("key-points", true);
/** What key points are coloured by. */
const inked = remembered("key-points-by", "word");
export const WORD = "#5fe3a1";
export const NO_WORD = "#ffb85c";
const NO_DEPTH = "#9aa5b1";

/** The key points of a node while they are to be shown, else null. @param {string} map @param {NodeDetail} node */
export function useKeyPoints(map, node) {
  const wanted = shown.value && node.features > 0;
  const found = useFeatures(map, node.id, wanted);
  return wanted ? found : null;
}

/** The key points of a node. @param {string} map @param {number} node @param {boolean} wanted */
export function useFeatures(map, node, wanted) {
  const { data } = useFetched(
    async (signal) => ({ node, found: wanted ? await get("/api/maps/{map}/nodes/{node_id}/features", { path: { map, node_id: node }, signal }) : null }),
    [map, node, wanted],
  );
  // The last answer stays until the next is here: those of another node are not this one's.
  return data.value?.node === node ? data.value.found : null;
}

/** @param {{node: NodeDetail, features: NodeFeatures | null}} props */
export function KeyPointsToggle({ node, features }) {
  const words = features?.word.filter((word) => word > 0).length ?? 0;
  return html`${h(Chip, {
      label: "Key points",
      on: shown.value && node.features > 0,
      disabled: !node.features,
      hint: node.features ? undefined : "No key points are stored for this node",
      onChange: (on) => (shown.value = on),
    })}
    ${features &&
    html`<label class="chip chip-select">
      by
      <select aria-label="Colours of key points" value=${inked.value} onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => (inked.value = currentTarget.value)}>
        <option value="word">word</option>
        <option value="depth">depth</option>
      </select>
    </label>`}
    <span class="quiet small clip">
      ${features && html`${text.whole(features.x.length)}, of them <span class="ink-good">${text.whole(words)} words</span>`}
    </span>`;
}

/**
 * @typedef {object} ColourProps
 * @property {string} map
 * @property {NodeDetail} node
 * @property {NodeFeatures | null} features
 * @property {(place: import("./canvas.js").Place | null) => void} [onPoint]
 */

/** @param {ColourProps} props */
export function ColourPicture({ map, node, features, onPoint }) {
  const { image, missing } = useImage(node.has_image ? address("api", "maps", map, "nodes", node.id, "image") : null);
  const veiled = (node.has_depth || node.has_right) && veil.value > 0;
  const over = useImage(veiled ? depthAddress(map, node.id) : null);
  if (!node.has_image) return html`<div class="picture-none quiet">No colour image is stored.</div>`;
  if (missing) return html`<div class="picture-none quiet">The colour image can't be shown: it is damaged.</div>`;
  const depth = veiled ? over.image : null;
  return h(Canvas, {
    label: `Colour image of node ${node.id}`,
    aspect: image ? image.naturalWidth / image.naturalHeight : 4 / 3,
    dependencies: [image, features, depth, veil.value, inked.value],
    pixels: image?.naturalWidth,
    onPoint,
    draw: (ctx, width, height) => {
      if (!image) return;
      ctx.drawImage(image, 0, 0, width, height);
      if (depth) drawVeil(ctx, depth, width, height);
      if (features) drawPoints(ctx, features, width / image.naturalWidth, inkOf(features));
    },
  });
}

/** @param {CanvasRenderingContext2D} ctx @param {HTMLImageElement} depth @param {number} width @param {number} height */
function drawVeil(ctx, depth, width, height) {
  ctx.globalAlpha = veil.value;
  ctx.imageSmoothingEnabled = false;
  ctx.drawImage(depth, 0, 0, width, height);
  ctx.globalAlpha = 1;
}

/** @param {NodeFeatures} features @returns {Ink} */
function inkOf({ word, depth_m }) {
  if (inked.value !== "depth") return (i) => (word[i] > 0 ? WORD : NO_WORD);
  const known = depth_m.filter((depth) => depth !== null).sort((a, b) => Number(a) - Number(b));
  const [near, far] = [Number(known[0] ?? 0), Number(known[Math.floor(0.95 * known.length)] ?? 1)];
  return (i) => {
    const depth = depth_m[i];
    if (depth === null) return NO_DEPTH;
    const share = Math.max(0, Math.min(1, (depth - near) / Math.max(far - near, 1e-6)));
    return `hsl(${Math.round(240 - 240 * share)} 95% 62%)`;
  };
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {NodeFeatures} features
 * @param {number} scale of the image on the canvas
 * @param {Ink} ink
 * @param {number} [left] of the image on the canvas
 * @param {(index: number) => boolean} [wanted]
 */
export function drawPoints(ctx, { x, y, size }, scale, ink, left = 0, wanted = () => true) {
  ctx.lineWidth = 1.1;
  ctx.globalAlpha = 0.85;
  for (let i = 0; i < x.length; i += 1) {
    if (!wanted(i)) continue;
    ctx.strokeStyle = ink(i);
    ctx.beginPath();
    // Pixel centres have whole coordinates.
    ctx.arc(left + (x[i] + 0.5) * scale, (y[i] + 0.5) * scale, Math.max(1.3, Math.min(9, (size[i] / 7) * scale)), 0, 2 * Math.PI);
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
}
