// The address of what is on screen: #/map/<id>/<view>/<key>?query. Every view reopens from its link, and so does a moment.
import { batch, computed, signal } from "@preact/signals";

/** @typedef {"maps" | "nodes" | "loops" | "params" | "stats" | "graph"} View */
/** @typedef {{map: string | null, view: View, key: string | null, query: URLSearchParams}} Route */

/** @type {readonly View[]} */
export const VIEWS = ["maps", "nodes", "loops", "params", "stats", "graph"];

const hash = signal(location.hash);

/** @type {import("@preact/signals").ReadonlySignal<Route>} */
export const route = computed(() => parse(hash.value));
export const openMapId = computed(() => route.value.map);
/** The node whose update is shown, null for the map as it is now: a part of every link within its map. */
export const moment = signal(momentIn(location.hash));

export function startRouter() {
  addEventListener("hashchange", () => arrive(location.hash));
}

/** @param {string} text */
function arrive(text) {
  batch(() => {
    hash.value = text;
    moment.value = momentIn(text);
  });
}

/** @param {string} text @returns {number | null} */
function momentIn(text) {
  const { map, query } = parse(text);
  const at = Number(query.get("at"));
  return map && Number.isInteger(at) && at > 0 ? at : null;
}

/** @param {string} text @returns {Route} */
export function parse(text) {
  const [path, query] = text.replace(/^#\/?/, "").split("?");
  const parts = path.split("/").filter(Boolean).map(decoded);
  const map = parts[0] === "map" && parts[1] ? parts[1] : null;
  const [view, key] = map ? parts.slice(2) : [parts[0], undefined];
  const known = VIEWS.find((name) => name === view);
  return { map, view: known ?? (map ? "loops" : "maps"), key: key ?? null, query: new URLSearchParams(query) };
}

/** @param {string} part a hand-made link may hold a lone % */
function decoded(part) {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

/**
 * The link of a route; what isn't named stays as it is, but for key and query, which belong to their view.
 * @param {{map?: string | null, view?: View, key?: string | number | null, query?: Record<string, string>}} to
 */
export function link(to) {
  const map = to.map === undefined ? route.value.map : to.map;
  const view = to.view ?? route.value.view;
  const parts = map ? ["map", map, view] : ["maps"];
  if (map && to.key !== undefined && to.key !== null) parts.push(String(to.key));
  const query = new URLSearchParams(to.query);
  query.delete("at");
  if (map && map === openMapId.value && moment.value !== null) query.set("at", String(moment.value));
  return `#/${parts.map(encodeURIComponent).join("/")}${query.size ? `?${query}` : ""}`;
}

/**
 * @param {Parameters<typeof link>[0]} to
 * @param {{replace?: boolean}} [how] replace: don't add a step to the browser's history
 */
export function go(to, { replace = false } = {}) {
  const target = link(to);
  if (target === location.hash) return;
  if (replace) history.replaceState(null, "", target);
  else history.pushState(null, "", target);
  arrive(target);
}

/** Writes the moment into the address of what is on screen. */
export function keepMoment() {
  const { key, query } = route.value;
  go({ key, query: Object.fromEntries(query) }, { replace: true });
}

/** Whether a route shows something at all; an empty hash leaves the choice to the page. */
export function isFresh() {
  return location.hash.length <= 2;
}
