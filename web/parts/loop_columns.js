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
    { key: "state", label: "State", width: "74px", sortable: true, cell: ({ state, reason }) => h(StateBadge, { state, hint: reason?.text }) },
    { key: "from", label: "Nodes", width: "minmax(80px, 1fr)", sortable: true, cell: ({ from, to }) => html`${from} <span class="quiet">→</span> ${to}` },
    { key: "type", label: "Type", width: "66px", sortable: true, cell: ({ type }) => h(LinkName, { type }) },
    { key: "posterior", label: "P", width: "36px", sortable: true, number: true, hint: "Loop hypothesis, compared with LoopThr", cell: ({ posterior }) => text.fixed(posterior) },
    {
      key: "inliers",
      label: "Inliers",
      width: "60px",
      sortable: true,
      number: true,
      hint: "Matches that agree with the transform, of all matches",
      cell: ({ inliers, matches }) => (matches === null || matches < 0 ? text.NONE : html`${inliers}<span class="quiet">/${matches}</span>`),
    },
    {
      key: "residual_sigma",
      label: "Resid. σ",
      width: "58px",
      sortable: true,
      number: true,
      hint: "How far the optimised graph is from this measurement, in its own standard deviations",
      cell: ({ residual_sigma: sigma }) =>
        html`<span class=${cx(sigma !== null && sigma >= SUSPECT_SIGMA && "ink-bad strong")}>${sigmaText(sigma)}</span>`,
    },
  ];
}
