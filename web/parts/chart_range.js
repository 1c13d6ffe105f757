// How high a chart reaches. One value far above all others would flatten the rest: it is cut off, and said.

/** @typedef {import("uplot")} uPlot */
/** @typedef {import("./chart.js").Column} Column */

/** With fewer values than this none is an exception. */
const LEAST = 20;
/** Of so many values one may be cut off, if it is so many times the highest that is not. */
const ONE_IN = 100;
const TIMES = 4;

/**
 * @param {number | null} low
 * @param {number | null} high
 * @param {boolean} fromZero
 * @param {{thresholds?: import("./chart_guides.js").Threshold[]}} guides
 * @returns {[number, number]}
 */
export function yRange(low, high, fromZero, { thresholds = [] }) {
  const values = [low ?? NaN, high ?? NaN, ...thresholds.map((one) => one.value)].filter(Number.isFinite);
  const top = Math.max(...values, fromZero ? 0 : -Infinity);
  const bottom = fromZero ? Math.min(0, ...values) : Math.min(...values);
  if (!Number.isFinite(top) || top === bottom) return [bottom || 0, (bottom || 0) + 1];
  const air = (top - bottom) * 0.08;
  return [fromZero && bottom === 0 ? 0 : bottom - air, top + air];
}

/**
 * The highest value that is shown whole; null where all are.
 * @param {readonly Column[]} columns
 * @param {number} [from] first row that is in sight
 * @param {number} [to] last row
 */
export function ceiling(columns, from = 0, to = Infinity) {
  const seen = columns.flatMap((column) => column.slice(from, to + 1));
  const sorted = /** @type {number[]} */ (seen.filter((value) => Number.isFinite(value))).sort((a, b) => b - a);
  if (sorted.length < LEAST) return null;
  for (let cut = Math.max(1, Math.floor(sorted.length / ONE_IN)); cut > 0; cut--)
    if (sorted[cut] > 0 && sorted[cut - 1] > TIMES * sorted[cut]) return sorted[cut];
  return null;
}

/** The same for what a chart shows. @param {uPlot} u */
export function ceilingOf(u) {
  const [from, to] = u.series[0].idxs ?? [0, Infinity];
  return ceiling(/** @type {Column[]} */ (u.data.slice(1)), from, to);
}
