// The loops of the open map: fetched once, then only what later updates brought; all again after a decision, and now
// and then, since residuals change with every optimisation.
import { signal } from "@preact/signals";
import { get } from "./api.js";

/** @typedef {import("./types/http").Schemas["LoopRow"]} LoopRow */
/** @typedef {{states: string[], type: string, minInliers: number, order: string}} Filter no state named: all */

const ALL_EVERY_MS = 10_000;

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
    /** @type {Promise<void>} */
    this.queue = Promise.resolve();
    this.revision = signal(0);
  }

  /** @param {{all?: boolean}} [what] */
  pull({ all = false } = {}) {
    const whole = all || Date.now() - this.allAt > ALL_EVERY_MS;
    this.queue = this.queue.then(() => this.#fetch(whole ? 0 : this.after));
    return this.queue;
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
    return counts;
  }

  /** @param {Filter} filter @returns {LoopRow[]} */
  rows({ states, type, minInliers, order }) {
    const fits = (/** @type {LoopRow} */ loop) =>
      (!states.length || states.includes(loop.state)) && (!type || loop.type === type) && (!minInliers || (loop.inliers ?? 0) >= minInliers);
    const down = order.startsWith("-");
    const key = order.replace("-", "");
    const sign = down ? -1 : 1;
    return [...this.byKey.values()].filter(fits).sort((a, b) => compare(value(a, key), value(b, key), sign) || b.from - a.from);
  }
}

/** What a loop is sorted by. @param {LoopRow} loop @param {string} key @returns {unknown} */
function value(loop, key) {
  return key === "doubt" ? loop.doubt?.score : loop[/** @type {keyof LoopRow} */ (key)];
}

/** What has no value comes last, whichever way one sorts. @param {any} a @param {any} b @param {number} sign */
function compare(a, b, sign) {
  if (a === null || a === undefined) return b === null || b === undefined ? 0 : 1;
  if (b === null || b === undefined) return -1;
  return a < b ? -sign : a > b ? sign : 0;
}
