// A node's colour image with its key points.
import { h, html } from "../html.js";
import { address, get } from "../api.js";
import * as text from "../format.js";
import { remembered } from "../prefs.js";
import { Chip } from "./button.js";
import { Canvas, useImage } from "./canvas.js";
import { useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {import("../store.js").Schemas["NodeFeatures"]} NodeFeatures */

const shown = remembered("key-points", true);
const WORD = "#5fe3a1";
const NO_WORD = "#ffb85c";

/** The key points of a node while they are to be shown, else null. @param {string} map @param {NodeDetail} node */
export function useKeyPoints(map, node) {
  const wanted = shown.value && node.features > 0;
  const { data } = useFetched(
    (signal) => (wanted ? get("/api/maps/{map}/nodes/{node_id}/features", { path: { map, node_id: node.id }, signal }) : null),
    [map, node.id, wanted],
  );
  return wanted ? data.value : null;
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
    <span class="quiet small clip">
      ${features && html`${text.whole(features.x.length)}, of them <span class="ink-good">${text.whole(words)} words</span>`}
    </span>`;
}

/** @param {{map: string, node: NodeDetail, features: NodeFeatures | null}} props */
export function ColourPicture({ map, node, features }) {
  const { image, missing } = useImage(node.has_image ? address("api", "maps", map, "nodes", node.id, "image") : null);
  if (!node.has_image) return html`<div class="picture-none quiet">No colour image is stored.</div>`;
  if (missing) return html`<div class="picture-none quiet">The colour image can't be shown: it is damaged.</div>`;
  return h(Canvas, {
    label: `Colour image of node ${node.id}`,
    aspect: image ? image.naturalWidth / image.naturalHeight : 4 / 3,
    dependencies: [image, features],
    draw: (ctx, width, height) => {
      if (!image) return;
      ctx.drawImage(image, 0, 0, width, height);
      if (features) drawPoints(ctx, features, width / image.naturalWidth);
    },
  });
}

/** @param {CanvasRenderingContext2D} ctx @param {NodeFeatures} features @param {number} scale */
function drawPoints(ctx, { x, y, size, word }, scale) {
  ctx.lineWidth = 1.1;
  ctx.globalAlpha = 0.85;
  for (let i = 0; i < x.length; i += 1) {
    ctx.strokeStyle = word[i] > 0 ? WORD : NO_WORD;
    ctx.beginPath();
    // Pixel centres have whole coordinates.
    ctx.arc((x[i] + 0.5) * scale, (y[i] + 0.5) * scale, Math.max(1.3, Math.min(9, (size[i] / 7) * scale)), 0, 2 * Math.PI);
    ctx.stroke();
  }
}
