// How depth images look: their colours, from which depth to which, and how much of them lies over the colour image.
import { address } from "./api.js";
import { remembered } from "./prefs.js";

/** @typedef {import("./types/api").components["schemas"]} Schemas */

export const DEPTH_COLOURS = /** @type {const} */ (["turbo", "viridis", "jet", "gray"]);

export const depthColours = remembered("depth-colours", "turbo");
/** Metres; 0 as the farthest lets each image choose. */
export const nearest = remembered("depth-nearest", 0);
export const farthest = remembered("depth-farthest", 0);
/** Whether pixels at the edges of things are shown as well. */
export const withEdges = remembered("depth-edges", true);
/** Share of the depth in the colour image, 0 for none. */
export const veil = remembered("depth-veil", 0);

/** What was chosen to be beside the colour image. */
export const secondShown = remembered("stereo-second", "right");

/**
 * What there may be beside the colour image.
 * @param {{has_right: boolean, has_depth: boolean, has_confidence: boolean}} node
 */
export function secondsOf({ has_right, has_depth, has_confidence }) {
  if (has_right) return ["right", "disparity", "depth"];
  return has_confidence && has_depth ? ["depth", "confidence"] : ["depth"];
}

/** What is there. @param {Parameters<typeof secondsOf>[0]} node */
export function secondOf(node) {
  const there = secondsOf(node);
  return there.includes(secondShown.value) ? secondShown.value : there[0];
}

/** @param {string} map @param {number} node @param {"disparity" | "confidence"} what */
export function colouredAddress(map, node, what) {
  return `${address("api", "maps", map, "nodes", node, `${what}.png`)}?colours=${depthColours.value}`;
}

/** @param {string} map @param {number} node */
export function depthAddress(map, node) {
  const query = new URLSearchParams({ colours: depthColours.value, min: String(nearest.value), max: String(farthest.value), edges: String(withEdges.value) });
  return `${address("api", "maps", map, "nodes", node, "depth.png")}?${query}`;
}
