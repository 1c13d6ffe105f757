// Two nodes beside each other: the address has the second as ?b=, and one of both is where clicks go.
import { signal } from "@preact/signals";
import { go, route } from "./router.js";

/** @typedef {"a" | "b"} Side */

/** Where the next node goes that somebody clicks in the table or in the 3D view. @type {import("@preact/signals").Signal<Side>} */
export const side = signal("b");

/** The second node; null while one is looked at alone. */
export function second() {
  const { view, query } = route.value;
  const id = Number(query.get("b"));
  return view === "nodes" && Number.isInteger(id) && id > 0 ? id : null;
}

/** A node was clicked. @param {number} id */
export function pickNode(id) {
  if (second() !== null && side.value === "b") setSecond(id);
  else setFirst(id);
}

/** @param {number} id @param {{replace?: boolean}} [how] */
export function setFirst(id, how) {
  go({ view: "nodes", key: id, query: Object.fromEntries(route.value.query) }, how);
}

/** @param {number | null} id null: only the first is left @param {{replace?: boolean}} [how] */
export function setSecond(id, how) {
  const { key, query } = route.value;
  const { b: _, ...others } = Object.fromEntries(query);
  if (id !== null && second() === null) side.value = "b";
  go({ view: "nodes", key, query: id === null ? others : { ...others, b: String(id) } }, how);
}

export function swap() {
  const { key, query } = route.value;
  const b = query.get("b");
  if (key && b) go({ view: "nodes", key: b, query: { ...Object.fromEntries(query), b: key } });
}
