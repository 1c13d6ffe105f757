// The columns of the review queue.
import { cx, h, html } from "../html.js";
import * as text from "../format.js";
import { Badge } from "./facts.js";
import { LinkName } from "./link_name.js";

/** @typedef {import("../loop_list.js").LoopRow} LoopRow */

/** @type {Record<string, [import("./facts.js").Tone, string]>} state -> tone, word */
const STATES = {
  accepted: ["good", "accepted"],
  refused: ["bad", "refused"],
  approved: ["accent", "approved"],
  rejected: ["quiet", "rejected"],
  added: ["hand", "by hand"],
};
/** Residuals from here on are worth a look. */
const SUSPECT_SIGMA = 3;
/** So is a doubt. */
export const SUSPECT = 1;

/** @param {{state: string, hint?: string}} props */
function StateBadge({ state, hint }) {
  const [tone, word] = STATES[state] ?? ["quiet", state];
  return h(Badge, { tone, hint, children: word });
}

/** @param {number | null} sigma */
export function sigmaText(sigma) {
  return text.fixed(sigma, sigma !== null && sigma < 1 ? 2 : 1);
}

/** @returns {import("./table.js").TableColumn<LoopRow>[]} */
export function loopColumns() {
  return [
    { key: "state", label: "State", width: "68px", sortable: true, cell: ({ state, reason }) => h(StateBadge, { state, hint: reason?.text }) },
    { key: "from", label: "Nodes", width: "minmax(64px, 1fr)", sortable: true, cell: ({ from, to }) => html`${from} <span class="quiet">→</span> ${to}` },
    { key: "type", label: "Type", width: "62px", sortable: true, cell: ({ type }) => h(LinkName, { type }) },
    { key: "posterior", label: "P", width: "30px", sortable: true, number: true, hint: "Loop hypothesis, compared with LoopThr", cell: ({ posterior }) => text.fixed(posterior) },
    {
      key: "inliers",
      label: "Inliers",
      width: "52px",
      sortable: true,
      number: true,
      hint: "Matches that agree with the transform, of all matches",
      cell: ({ inliers, matches }) => (matches === null || matches < 0 ? text.NONE : html`${inliers}<span class="quiet">/${matches}</span>`),
    },
    {
      key: "doubt",
      label: "Doubt",
      width: "44px",
      sortable: true,
      number: true,
      hint: "What speaks against it, of odometry, the loops near by and the optimised graph: above 1 it is suspect",
      cell: ({ doubt }) => html`<span class=${cx(doubt !== null && doubt.score >= SUSPECT && "ink-bad strong")}>${doubt ? sigmaText(doubt.score) : text.NONE}</span>`,
    },
    {
      key: "residual_sigma",
      label: "σ",
      width: "42px",
      sortable: true,
      number: true,
      hint: "How far the optimised graph is from this measurement, in its own standard deviations",
      cell: ({ residual_sigma: sigma }) =>
        html`<span class=${cx(sigma !== null && sigma >= SUSPECT_SIGMA && "ink-bad strong")}>${sigmaText(sigma)}</span>`,
    },
  ];
}
