// Both images of a link side by side, with a line for each match.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { address, get } from "../api.js";
import { useKeys } from "../keys.js";
import { remembered } from "../prefs.js";
import { Chip } from "./button.js";
import { Canvas, useImage } from "./canvas.js";
import { Lightbox } from "./lightbox.js";
import { useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["LinkMatches"]} LinkMatches */

/** Pixels between both images. */
export const GAP = 2;
const INLIER = "#4be08f";
const OUTLIER = "#ff5a5a";
const LINE_ROOM_PX = 3;
const showInliers = remembered("inliers", true);
const showOutliers = remembered("outliers", true);

/** @param {{map: string, from: number, to: number}} props */
export function MatchPicture({ map, from, to }) {
  const [large, setLarge] = useState(false);
  const { data, error } = useFetched(
    (signal) => get("/api/maps/{map}/links/{from_id}/{to_id}/matches", { path: { map, from_id: from, to_id: to }, signal }),
    [map, from, to],
  );
  useKeys({ e: () => setLarge(!large) });
  const matches = data.value;
  const inliers = matches?.inlier.filter(Boolean).length ?? 0;
  const picture = h(Pair, { map, from, to, matches });
  return html`<figure class="picture">
    <button type="button" class="picture-large" title="Larger (E)" onClick=${() => setLarge(true)}>${picture}</button>
    <figcaption class="picture-bar">
      ${h(Chip, { label: `Inliers ${matches ? inliers : ""}`, on: showInliers.value, onChange: (on) => (showInliers.value = on) })}
      ${h(Chip, {
        label: `Outliers ${matches ? matches.inlier.length - inliers : ""}`,
        on: showOutliers.value,
        onChange: (on) => (showOutliers.value = on),
      })}
      <span class="grow quiet small clip">${error.value ? error.value.message : matches ? "matched anew for this view" : "matching…"}</span>
    </figcaption>
    ${large && h(Lightbox, { title: `Link ${from} → ${to}`, close: () => setLarge(false), children: picture })}
  </figure>`;
}

/** @param {{map: string, from: number, to: number, matches: LinkMatches | null}} props */
function Pair({ map, from, to, matches }) {
  const left = useImage(address("api", "maps", map, "nodes", from, "image"));
  const right = useImage(address("api", "maps", map, "nodes", to, "image"));
  if (left.missing && right.missing) return html`<div class="picture-none quiet">No images are stored for these nodes.</div>`;
  const first = left.image ?? right.image;
  const one = first ? first.naturalWidth / first.naturalHeight : 4 / 3;
  return h(Canvas, {
    label: `Images of node ${from} (left) and node ${to} (right) with their matches`,
    aspect: 2 * one,
    dependencies: [left.image, right.image, matches, showInliers.value, showOutliers.value],
    pixels: first && 2 * first.naturalWidth + GAP,
    draw: (ctx, width, height) => {
      const half = (width - GAP) / 2;
      if (left.image) ctx.drawImage(left.image, 0, 0, half, height);
      if (right.image) ctx.drawImage(right.image, half + GAP, 0, half, height);
      if (matches) drawMatches(ctx, matches, half);
    },
  });
}

/** @param {CanvasRenderingContext2D} ctx @param {LinkMatches} matches @param {number} half width of one image */
function drawMatches(ctx, matches, half) {
  // Outliers first, so that they never cover what holds the link together.
  if (showOutliers.value) drawKind(ctx, matches, half, false);
  if (showInliers.value) drawKind(ctx, matches, half, true);
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {LinkMatches} matches
 * @param {number} half
 * @param {boolean} inlier
 */
function drawKind(ctx, matches, half, inlier) {
  const ends = endPoints(matches, half, inlier);
  if (inlier) drawLines(ctx, ends, half, { colour: INLIER, width: 1, alpha: 0.6, points: 0.85 });
  else drawLines(ctx, ends, half, { colour: OUTLIER, width: 0.7, alpha: 0.35, points: 0.5 });
}

/**
 * A point at each end, and as many lines as one can tell apart.
 * @param {CanvasRenderingContext2D} ctx
 * @param {number[][]} ends x and y of both ends
 * @param {number} half width of one image
 * @param {{colour: string, width: number, alpha: number, points: number}} ink opacity of lines and of points
 */
export function drawLines(ctx, ends, half, { colour, width, alpha, points }) {
  const every = Math.ceil(ends.length / (half / LINE_ROOM_PX));
  ctx.strokeStyle = ctx.fillStyle = colour;
  ctx.lineWidth = width;
  ends.forEach(([ax, ay, bx, by], index) => {
    if (index % every === 0) {
      ctx.globalAlpha = alpha;
      ctx.beginPath();
      ctx.moveTo(ax, ay);
      ctx.lineTo(bx, by);
      ctx.stroke();
    }
    ctx.globalAlpha = points;
    ctx.fillRect(ax - 1, ay - 1, 2, 2);
    ctx.fillRect(bx - 1, by - 1, 2, 2);
  });
  ctx.globalAlpha = 1;
}

/**
 * Both ends of each match on the canvas; pixel centres have whole coordinates.
 * @param {LinkMatches} matches
 * @param {number} half
 * @param {boolean} wanted inliers or outliers
 */
function endPoints({ from, to, x1, y1, x2, y2, inlier }, half, wanted) {
  const [left, right] = [half / from.width, half / to.width];
  return x1.flatMap((x, i) =>
    inlier[i] === wanted
      ? [[(x + 0.5) * left, (y1[i] + 0.5) * left, half + GAP + (x2[i] + 0.5) * right, (y2[i] + 0.5) * right]]
      : [],
  );
}
