// Rows of the node table, fetched in pages as they come into sight.
import { signal } from "@preact/signals";
import { get } from "./api.js";

/** @typedef {import("./types/http").Schemas["NodeRow"]} NodeRow */
/** @typedef {import("./types/api").paths["/api/maps/{map}/nodes"]["get"]["parameters"]["query"]} NodeQuery */
/** @typedef {NonNullable<NonNullable<NodeQuery>["order"]>} NodeOrder */

const PAGE = 100;
/** Most rows of one answer. */
const AT_ONCE = 500;
/** Weight of nodes that left the map: nothing can be done to them. */
const DROPPED = -9;

export class Window {
  /** @param {string} map */
  constructor(map) {
    this.map = map;
    this.order = /** @type {NodeOrder} */ ("id");
    this.query = "";
    this.dropped = false;
    /** The node whose row is wanted, and that row; null where it is not in the table. */
    this.wanted = 0;
    this.row = /** @type {number | null} */ (null);
    this.total = 0;
    this.loaded = false;
    /** @type {Error | null} */
    this.error = null;
    /** @type {Map<number, NodeRow[]>} */
    this.pages = new Map();
    /** @type {Set<number>} */
    this.asked = new Set();
    this.first = 0;
    this.last = PAGE;
    /** Answers to questions of an earlier generation are dropped. */
    this.generation = 0;
    this.underway = 0;
    this.stale = false;
    this.revision = signal(0);
  }

  /** @param {NodeOrder} order @param {string} query @param {boolean} dropped merged and dropped nodes as well */
  ask(order, query, dropped = false) {
    this.order = order;
    this.query = query;
    this.dropped = dropped;
    this.generation += 1;
    this.underway = 0;
    this.pages.clear();
    this.refresh();
  }

  /** Fetch again what is in sight, once what is on its way is here; the old rows stay until then. */
  refresh() {
    this.stale = this.underway > 0;
    if (this.stale) return;
    this.asked.clear();
    this.show(this.first, this.last);
  }

  /** @param {number} first @param {number} last rows in sight */
  show(first, last) {
    this.first = first;
    this.last = last;
    for (let page = Math.floor(first / PAGE); page <= Math.floor(Math.max(first, last - 1) / PAGE); page += 1) {
      if (!this.asked.has(page)) void this.#fetch(page);
    }
  }

  /** @param {number} index */
  at(index) {
    return index < 0 ? undefined : this.pages.get(Math.floor(index / PAGE))?.[index % PAGE];
  }

  /** Index of a node among the rows that are here, else -1. @param {number} id */
  find(id) {
    for (const [page, rows] of this.pages) {
      const row = rows.findIndex((one) => one.id === id);
      if (row >= 0) return page * PAGE + row;
    }
    return -1;
  }

  /** Learn the row of a node that may not be here yet. @param {number} id */
  seek(id) {
    this.wanted = id;
    this.row = null;
    if (this.loaded && this.find(id) < 0) void this.#fetch(Math.floor(this.first / PAGE));
    // It is known which row is meant, without anything having arrived.
    else this.revision.value += 1;
  }

  /** Index of a node, here or sought; -1 while it isn't known and where it is not in the table. @param {number} id */
  indexOf(id) {
    const here = this.find(id);
    return here < 0 && id === this.wanted ? (this.row ?? -1) : here;
  }

  /** Ids of the rows of a range, whether they are here or not. @param {number} first @param {number} last */
  async ids(first, last) {
    const ids = [];
    for (let offset = first; offset < last; offset += AT_ONCE) {
      const query = { offset, limit: Math.min(AT_ONCE, last - offset), order: this.order, q: this.query, dropped: this.dropped };
      const found = await get("/api/maps/{map}/nodes", { path: { map: this.map }, query });
      ids.push(...found.nodes.filter(({ weight }) => weight !== DROPPED).map(({ id }) => id));
    }
    return ids;
  }

  /** Ids from one to another, whatever the filter shows. @param {number} first @param {number} last */
  async stretch(first, last) {
    const all = new Window(this.map);
    return (await all.ids(0, (await all.count()))).filter((id) => id >= first && id <= last);
  }

  /** How many nodes the map has. */
  async count() {
    return (await get("/api/maps/{map}/nodes", { path: { map: this.map }, query: { limit: 1 } })).total;
  }

  /** @param {number} page */
  async #fetch(page) {
    this.asked.add(page);
    this.underway += 1;
    const generation = this.generation;
    const query = { offset: page * PAGE, limit: PAGE, order: this.order, q: this.query, dropped: this.dropped, find: this.wanted || undefined };
    try {
      const found = await get("/api/maps/{map}/nodes", { path: { map: this.map }, query });
      if (generation !== this.generation) return;
      this.total = found.total;
      if (query.find === this.wanted) this.row = found.at;
      this.pages.set(page, found.nodes);
      this.error = null;
    } catch (error) {
      if (generation !== this.generation) return;
      this.error = /** @type {Error} */ (error);
    }
    this.loaded = true;
    this.underway -= 1;
    this.revision.value += 1;
    if (this.stale) this.refresh();
  }
}
