// The pixel of a node's images under the pointer, and what the server says of it.
import { signal } from "@preact/signals";
import { get } from "./api.js";
import { latest } from "./latest.js";

/** @typedef {import("./types/http").Schemas["PixelDepth"]} PixelDepth */
/** @typedef {{map: string, node: number, place: import("./parts/canvas.js").Place}} Pointed */

/** @type {import("@preact/signals").Signal<Pointed | null>} */
export const pointed = signal(null);
/** @type {import("@preact/signals").Signal<{node: number, pixel: PixelDepth | null, error: string} | null>} */
export const told = signal(null);

const ask = latest(async (/** @type {Pointed} */ { map, node, place: [x, y] }) => {
  const path = { map, node_id: node };
  try {
    const pixel = await get("/api/maps/{map}/nodes/{node_id}/pixel", { path, query: { x, y } });
    if (pointed.value?.node === node) told.value = { node, pixel, error: "" };
  } catch (error) {
    if (pointed.value?.node === node) told.value = { node, pixel: null, error: /** @type {Error} */ (error).message };
  }
});

/**
 * @param {string} map
 * @param {{id: number, has_depth: boolean, has_right: boolean}} node
 * @param {import("./parts/canvas.js").Place | null} place
 */
export function pointAt(map, node, place) {
  pointed.value = place && { map, node: node.id, place };
  if (!place) told.value = null;
  else if (node.has_depth || node.has_right) void ask({ map, node: node.id, place });
}
