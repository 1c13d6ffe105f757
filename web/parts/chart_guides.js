// What lies over a chart: dashed threshold lines, and a mark wherever a loop was closed.
import * as text from "../format.js";
import { color } from "../theme.js";
import { ceilingOf } from "./chart_range.js";

/** @typedef {import("uplot")} uPlot */
/** @typedef {{value: number, token: string}} Threshold */
/** @typedef {{at: number, height: number}} Mark a loop, at x, with the hypothesis that led to it; 0 for a proximity one */

/**
 * @param {uPlot} u
 * @param {{thresholds?: Threshold[], marks?: Mark[], stems?: boolean, shown?: number | null}} guides stems: as high as the
 *   mark's value; shown: where a moment of the past is
 */
export function drawGuides(u, { thresholds = [], marks = [], stems = false, shown = null }) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.strokeStyle = ctx.fillStyle = color("loop");
  for (const mark of marks) drawMark(u, mark, stems);
  for (const { value, token } of thresholds) drawThreshold(u, value, color(token));
  if (shown !== null) drawShown(u, shown);
  ctx.restore();
}

/** @param {uPlot} u @param {number} at */
function drawShown(u, at) {
  const { ctx, bbox } = u;
  ctx.fillStyle = color("ink");
  ctx.fillRect(u.valToPos(at, "x", true) - devicePixelRatio, bbox.top, 2 * devicePixelRatio, bbox.height);
}

/**
 * Triangles while there is room for them, else ticks; stems never wider than half the way to the next one.
 * @param {uPlot} u
 * @param {Mark} mark
 * @param {boolean} stem
 */
function drawMark(u, { at, height }, stem) {
  const { ctx, bbox } = u;
  const px = devicePixelRatio;
  const x = u.valToPos(at, "x", true);
  const apart = u.valToPos(at + 1, "x", true) - x;
  const half = Math.max(0.5 * px, Math.min(3 * px, apart / 2));
  ctx.globalAlpha = height ? 0.9 : 0.45;
  ctx.beginPath();
  ctx.moveTo(x - half, bbox.top);
  ctx.lineTo(x + half, bbox.top);
  ctx.lineTo(x, bbox.top + 5 * px);
  ctx.fill();
  if (stem && height) {
    ctx.lineWidth = Math.max(0.5, Math.min(2 * px, apart / 2));
    ctx.beginPath();
    ctx.moveTo(x, u.valToPos(0, "y", true));
    ctx.lineTo(x, u.valToPos(height, "y", true));
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
}

/** @param {uPlot} u @param {number} value @param {string} stroke */
function drawThreshold({ ctx, bbox, valToPos }, value, stroke) {
  const y = Math.round(valToPos(value, "y", true)) + 0.5;
  ctx.strokeStyle = stroke;
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash([6, 5]);
  ctx.beginPath();
  ctx.moveTo(bbox.left, y);
  ctx.lineTo(bbox.left + bbox.width, y);
  ctx.stroke();
}

/** How high what is cut off would reach, beside its place at the top. @param {uPlot} u */
export function drawCutOff(u) {
  const most = ceilingOf(u);
  if (most === null) return;
  const { ctx, bbox } = u;
  ctx.save();
  ctx.fillStyle = color("ink-2");
  ctx.font = `${10 * devicePixelRatio}px system-ui, "DejaVu Sans", sans-serif`;
  ctx.textBaseline = "top";
  const highest = (/** @type {number} */ row) => Math.max(...u.data.slice(1).map((column) => column[row] ?? -Infinity));
  const [from, to] = u.series[0].idxs ?? [0, u.data[0].length - 1];
  for (let row = from; row <= to; row++) {
    if (highest(row) <= most) continue;
    const [x, label] = [u.valToPos(u.data[0][row], "x", true), `↑ ${text.short(highest(row))}`];
    ctx.textAlign = x > bbox.left + bbox.width / 2 ? "right" : "left";
    ctx.fillText(label, x + (ctx.textAlign === "left" ? 3 : -3) * devicePixelRatio, bbox.top + 7 * devicePixelRatio);
  }
  ctx.restore();
}
