// The loops of the open map: fetched once, then only what later updates brought; all again after a decision, and now
// and then, since residuals change with every optimisation.
import { signal } from "@preact/signals";
import { get } from "./api.js";
import { weightOf } from "./weights.js";
import { ALIKE, inlierRatio, SUSPECT } from "./parts/loop_columns.js";

/** @typedef {import("./types/http").Schemas["LoopRow"]} LoopRow */
/** @typedef {[number | null, number | null]} Range least and most, null for no bound */
/**
 * @typedef {object} LoopFilterState
 * @property {string[]} states none named: all
 * @property {boolean} suspect only those that something speaks against
 * @property {string} type empty for all
 * @property {number} minInliers
 * @property {number | null} session of either end
 * @property {Record<string, Range>} ranges by key of RANGES
 */
/** @typedef {LoopFilterState & {order: string}} Filter */

/** @type {LoopFilterState} */
export const NO_FILTER = { states: [], suspect: false, type: "", minInliers: 0, session: null, ranges: {} };

/** What loops can be filtered by, between two numbers. @type {{key: string, label: string, unit: string}[]} */
export const RANGES = [
  { key: "doubt", label: "Doubt", unit: "" },
  { key: "residual_sigma", label: "Residual", unit: "σ" },
  { key: "posterior", label: "Posterior", unit: "" },
  { key: "inliers", label: "Inliers", unit: "" },
  { key: "ratio", label: "Inlier ratio", unit: "" },
  { key: "look_alike", label: "Look-alike", unit: "share" },
  { key: "translation_m", label: "Length", unit: "m" },
  { key: "gnc", label: "GNC weight", unit: "" },
  { key: "graph_distance", label: "Apart", unit: "nodes" },
];

const ALL_EVERY_MS = 10_000;
/** One decision is heard of several times: as its answer, as a decision and as a new graph. */
const TOGETHER_MS = 50;

export class LoopList {
  /** @param {string} map */
  constructor(map) {
    this.map = map;
    /** @type {Map<string, LoopRow>} */
    this.byKey = new Map();
    this.after = 0;
    this.allAt = 0;
    this.loaded = false;
    /** @type {Error | null} */
    this.error = null;
    this.all = false;
    /** @type {Promise<void>} */
    this.queue = Promise.resolve();
    /** @type {Promise<void> | null} the last of the queue, until it begins */
    this.next = null;
    this.revision = signal(0);
  }

  /** What is asked for before the next request goes is asked for once. @param {{all?: boolean}} [what] */
  pull({ all = false } = {}) {
    this.all ||= all;
    this.next ??= this.queue = this.queue.then(() => this.#pullNext());
    return this.next;
  }

  async #pullNext() {
    if (this.loaded) await new Promise((resolve) => setTimeout(resolve, TOGETHER_MS));
    const whole = this.all || Date.now() - this.allAt > ALL_EVERY_MS;
    this.all = false;
    this.next = null;
    await this.#fetch(whole ? 0 : this.after);
  }

  /** @param {number} after update */
  async #fetch(after) {
    try {
      const { loops } = await get("/api/maps/{map}/loops", { path: { map: this.map }, query: { after } });
      if (after === 0) {
        this.byKey.clear();
        this.allAt = Date.now();
      }
      for (const loop of loops) this.byKey.set(loop.key, loop);
      this.after = Math.max(this.after, ...loops.map((loop) => loop.update));
      this.error = null;
    } catch (error) {
      this.error = /** @type {Error} */ (error);
    }
    this.loaded = true;
    this.revision.value += 1;
  }

  /** How many there are of each state. */
  counts() {
    /** @type {Record<string, number>} */
    const counts = {};
    for (const { state } of this.byKey.values()) counts[state] = (counts[state] ?? 0) + 1;
    counts.suspect = [...this.byKey.values()].filter(isSuspect).length;
    return counts;
  }

  /** Sessions that loops join, ascending. */
  sessions() {
    return [...new Set([...this.byKey.values()].flatMap(({ sessions }) => sessions))].sort((a, b) => a - b);
  }

  /** @param {Filter} filter @returns {LoopRow[]} */
  rows({ states, suspect, type, minInliers, session, ranges, order }) {
    const bounds = Object.entries(ranges);
    const fits = (/** @type {LoopRow} */ loop) =>
      (!states.length || states.includes(loop.state)) &&
      (!suspect || isSuspect(loop)) &&
      (!type || loop.type === type) &&
      (!minInliers || (loop.inliers ?? 0) >= minInliers) &&
      (session === null || loop.sessions.includes(session)) &&
      bounds.every(([key, [least, most]]) => within(value(loop, key), least, most));
    const down = order.startsWith("-");
    const key = order.replace("-", "");
    const sign = down ? -1 : 1;
    return [...this.byKey.values()].filter(fits).sort((a, b) => compare(value(a, key), value(b, key), sign) || b.from - a.from);
  }
}

/** What a loop is sorted and filtered by. @param {LoopRow} loop @param {string} key @returns {unknown} */
function value(loop, key) {
  if (key === "doubt") return loop.doubt?.score;
  if (key === "look_alike") return loop.look_alike?.share;
  if (key === "gnc") return weightOf(loop);
  if (key === "ratio") return inlierRatio(loop);
  if (key === "sessions") return Math.abs(loop.sessions[0] - loop.sessions[1]) * 1e6 + Math.max(...loop.sessions);
  return loop[/** @type {keyof LoopRow} */ (key)];
}

/** What isn't known is within no bounds. @param {unknown} of @param {number | null} least @param {number | null} most */
function within(of, least, most) {
  return typeof of === "number" && (least === null || of >= least) && (most === null || of <= most);
}

/** @param {LoopRow} loop */
function isSuspect({ state, doubt, look_alike: alike }) {
  const stands = state === "accepted" || state === "refused";
  return stands && ((doubt?.score ?? 0) >= SUSPECT || (state === "accepted" && (alike?.share ?? 0) >= ALIKE));
}

/** What has no value comes last, whichever way one sorts. @param {any} a @param {any} b @param {number} sign */
function compare(a, b, sign) {
  if (a === null || a === undefined) return b === null || b === undefined ? 0 : 1;
  if (b === null || b === undefined) return -1;
  return a < b ? -sign : a > b ? sign : 0;
}
