// Both paths from above, with the loops that come, go and stay.
import { h, html } from "../html.js";
import { color, theme } from "../theme.js";
import { Canvas } from "./canvas.js";

/** @typedef {import("./trial.js").Comparison} Comparison */
/** @typedef {import("./trial.js").Side} Side */
/** @typedef {(x: number, y: number) => [number, number]} Place */

const ASPECT = 2;
const MARGIN_PX = 12;
/** A step longer than this many times the median leads from one session to the next, or is a jump: no line. */
const JUMP = 12;

/** @param {{found: Comparison}} props */
export function TrialPaths({ found }) {
  const { baseline, tried } = found;
  return html`<figure class="trial-paths">
    <figcaption class="small">
      <b>From above</b>
      <span class="ink-before">as it was</span> <span class="ink-accent">tried</span>
      <span class="ink-coming">loops that come</span> <span class="ink-going">loops that go</span>
    </figcaption>
    ${h(Canvas, {
      label: `Paths of ${baseline.ids.length} and ${tried.ids.length} nodes from above`,
      aspect: ASPECT,
      draw: (ctx, width, height) => draw(ctx, width, height, found),
      dependencies: [found, theme.value],
    })}
  </figure>`;
}

/** @param {CanvasRenderingContext2D} ctx @param {number} width @param {number} height @param {Comparison} found */
function draw(ctx, width, height, { baseline, tried, came, gone }) {
  const place = fit([...baseline.poses, ...tried.poses], width, height);
  if (!place) return;
  const [before, after] = [positions(baseline), positions(tried)];
  const [coming, going] = [came, gone].map((loops) => loops.map(({ key }) => key.split("-").map(Number)));
  const changed = new Set([...coming].map(([from, to]) => `${to}-${from}`));
  const staying = tried.loop_pairs.filter(([a, b]) => !changed.has(`${a}-${b}`));
  strokePairs(ctx, staying, after, place, color("line-strong"), 1);
  strokePath(ctx, baseline, place, color("ink-3"), 1.5);
  strokePath(ctx, tried, place, color("accent"), 1.5);
  strokePairs(ctx, going, before, place, color("bad"), 1.5, [4, 3]);
  strokePairs(ctx, coming, after, place, color("good"), 1.5);
}

/** From metres to pixels, x to the right and y up, the same scale for both. @param {number[][]} poses @param {number} width @param {number} height @returns {Place | null} */
function fit(poses, width, height) {
  if (!poses.length) return null;
  const [left, right] = range(poses, 0);
  const [low, high] = range(poses, 1);
  const scale = Math.min((width - 2 * MARGIN_PX) / Math.max(right - left, 0.1), (height - 2 * MARGIN_PX) / Math.max(high - low, 0.1));
  const [middleX, middleY] = [(left + right) / 2, (low + high) / 2];
  return (x, y) => [width / 2 + (x - middleX) * scale, height / 2 - (y - middleY) * scale];
}

/** @param {number[][]} poses @param {number} axis @returns {[number, number]} */
function range(poses, axis) {
  let [low, high] = [Infinity, -Infinity];
  for (const pose of poses) [low, high] = [Math.min(low, pose[axis]), Math.max(high, pose[axis])];
  return [low, high];
}

/** @param {Side} side @returns {Map<number, number[]>} */
function positions({ ids, poses }) {
  return new Map(ids.map((id, row) => [id, poses[row]]));
}

/** @param {CanvasRenderingContext2D} ctx @param {Side} side @param {Place} place @param {string} stroke @param {number} width */
function strokePath(ctx, { poses }, place, stroke, width) {
  const steps = poses.slice(1).map((pose, k) => Math.hypot(pose[0] - poses[k][0], pose[1] - poses[k][1]));
  const longest = JUMP * ([...steps].sort((a, b) => a - b)[Math.floor(steps.length / 2)] || Infinity);
  ctx.beginPath();
  poses.forEach(([x, y], k) => (k && steps[k - 1] <= longest ? ctx.lineTo(...place(x, y)) : ctx.moveTo(...place(x, y))));
  ctx.strokeStyle = stroke;
  ctx.lineWidth = width;
  ctx.setLineDash([]);
  ctx.stroke();
}

/** @param {CanvasRenderingContext2D} ctx @param {number[][]} pairs @param {Map<number, number[]>} at @param {Place} place @param {string} stroke @param {number} width @param {number[]} [dash] */
function strokePairs(ctx, pairs, at, place, stroke, width, dash = []) {
  ctx.beginPath();
  for (const [a, b] of pairs) {
    const [from, to] = [at.get(a), at.get(b)];
    if (!from || !to) continue;
    ctx.moveTo(...place(from[0], from[1]));
    ctx.lineTo(...place(to[0], to[1]));
  }
  ctx.strokeStyle = stroke;
  ctx.lineWidth = width;
  ctx.setLineDash(dash);
  ctx.stroke();
  ctx.setLineDash([]);
}
