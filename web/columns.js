// Columns of statistics of the open map, fetched once and then only by what is new.
import { signal } from "@preact/signals";
import { get } from "./api.js";

/** @typedef {(number | null)[]} Column */

/** Statistics of one map: row i of every column belongs to node ids[i]. */
export class Columns {
  /** @param {string} map */
  constructor(map) {
    this.map = map;
    /** @type {number[]} */
    this.ids = [];
    /** @type {number[]} */
    this.stamps = [];
    /** @type {Map<string, Column>} */
    this.values = new Map();
    /** @type {Map<string, number>} how many charts want a name */
    this.wanted = new Map();
    /** Grows with every change of the columns. */
    this.revision = signal(0);
    /** @type {import("@preact/signals").Signal<Error | null>} */
    this.error = signal(null);
    /** @type {Promise<void>} one fetch at a time: rows then arrive in order */
    this.queue = Promise.resolve();
    this.pending = false;
  }

  /**
   * Keep these columns up to date until the returned function is called.
   * @param {string[]} names
   */
  want(names) {
    for (const name of names) this.wanted.set(name, (this.wanted.get(name) ?? 0) + 1);
    this.#enqueue(() => this.#fill());
    return () => {
      for (const name of names) this.#release(name);
    };
  }

  /** Fetch the rows behind the last one. */
  pull() {
    if (this.pending) return;
    this.pending = true;
    this.#enqueue(async () => {
      this.pending = false;
      await this.#append();
    });
  }

  /** @param {string} name @returns {Column} */
  column(name) {
    return this.values.get(name) ?? [];
  }

  /** Newest value of a column. @param {string} name */
  last(name) {
    return this.column(name).findLast((value) => value !== null) ?? null;
  }

  /** @param {string} name */
  #release(name) {
    const left = (this.wanted.get(name) ?? 1) - 1;
    if (left > 0) this.wanted.set(name, left);
    else {
      this.wanted.delete(name);
      this.values.delete(name);
    }
  }

  /** @param {() => Promise<void>} job */
  #enqueue(job) {
    this.queue = this.queue.then(job).then(
      () => void (this.error.value = null),
      (error) => void (this.error.value = error),
    );
  }

  async #fill() {
    const missing = [...this.wanted.keys()].filter((name) => !this.values.has(name));
    if (!missing.length) return;
    const rows = await this.#fetch(missing, 0);
    if (!this.ids.length) this.#extend(rows.ids, rows.stamps);
    // Rows newer than the other columns come with the next pull, for all of them.
    for (const name of missing) this.values.set(name, rows.values[name].slice(0, this.ids.length));
    this.revision.value += 1;
    if (rows.ids.length > this.ids.length) await this.#append();
  }

  async #append() {
    const names = [...this.wanted.keys()].filter((name) => this.values.has(name));
    if (!names.length) return this.#fill();
    const rows = await this.#fetch(names, this.ids.at(-1) ?? 0);
    if (!rows.ids.length) return;
    this.#extend(rows.ids, rows.stamps);
    for (const name of names) this.values.get(name)?.push(...rows.values[name]);
    this.revision.value += 1;
  }

  /** @param {number[]} ids @param {number[]} stamps */
  #extend(ids, stamps) {
    this.ids.push(...ids);
    this.stamps.push(...stamps);
  }

  /** @param {string[]} names @param {number} after node id */
  #fetch(names, after) {
    return get("/api/maps/{map}/statistics", { path: { map: this.map }, query: { names: names.join(","), after } });
  }
}
