// RTAB-Map's link types in a word.
import { html } from "../html.js";

/** @type {Record<string, [string, string]>} type -> word, colour */
const WORDS = {
  Neighbor: ["neighbour", "ink-2"],
  GlobalClosure: ["global", "ink-loop"],
  LocalSpaceClosure: ["proximity", "ink-loop"],
  LocalTimeClosure: ["in time", "ink-loop"],
  UserClosure: ["by hand", "ink-hand"],
  VirtualClosure: ["virtual", "ink-2"],
  NeighborMerged: ["merged", "ink-2"],
  PosePrior: ["prior", "ink-2"],
  Landmark: ["landmark", "ink-2"],
  Gravity: ["gravity", "ink-2"],
};

/** @param {{type: string}} props */
export function LinkName({ type }) {
  return html`<span class=${WORDS[type]?.[1]} title=${type}>${WORDS[type]?.[0] ?? type}</span>`;
}
