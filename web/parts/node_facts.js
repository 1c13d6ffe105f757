// What is known of a node, as names and values.
import * as text from "../format.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */

/** @param {NodeDetail} node @returns {import("./facts.js").Fact[]} */
export function nodeFacts(node) {
  const day = text.day(node.stamp);
  return [
    ["Time", text.clock(node.stamp), `Stamp ${node.stamp.toFixed(6)} s`],
    ["Date", day, day === text.NONE ? "Stamps of this map don't count from 1970" : "UTC"],
    ["Session", `${text.whole(node.map_id)}, node ${text.whole(node.session_index)} of ${text.whole(node.session_nodes)}`, "Session number, and the place in it"],
    ["Memory", node.tier?.toUpperCase() ?? text.NONE],
    ["Weight", weightText(node.weight)],
    ["Label", node.label || text.NONE],
    ["Features", text.whole(node.features)],
    ["Words", text.whole(node.words)],
    ["Image", node.image_bytes ? text.size(node.image_bytes) : text.NONE, "As it is stored"],
    [node.has_right ? "Right" : "Depth", node.depth_bytes ? text.size(node.depth_bytes) : text.NONE, "As it is stored"],
    ["Links", linksText(node)],
    ["Loops", text.whole(node.loops)],
  ];
}

/** @param {NodeDetail} node */
function linksText({ id, links }) {
  return text.whole(links.filter(({ from, to }) => from !== to && (from === id || to === id)).length);
}

/** Weights that are none say what the node is. @param {number} weight */
function weightText(weight) {
  if (weight === -9) return "none: merged or dropped";
  return weight === -1 ? "none: only in the graph" : text.whole(weight);
}
