// The columns of the review queue.
import { cx, h, html } from "../html.js";
import * as text from "../format.js";
import { weightOf, weights } from "../weights.js";
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
/** So is a place elsewhere that was this likely, by the share of the loop's own place. */
export const ALIKE = 0.8;

/** @param {{state: string, hint?: string}} props */
function StateBadge({ state, hint }) {
  const [tone, word] = STATES[state] ?? ["quiet", state];
  return h(Badge, { tone, hint, children: word });
}

/** @param {number | null} sigma */
export function sigmaText(sigma) {
  return text.fixed(sigma, sigma !== null && sigma < 1 ? 2 : 1);
}

/** Columns that are there while one sorts by them. @type {import("./table.js").TableColumn<LoopRow>[]} */
const MORE = [
  { key: "ratio", label: "Ratio", width: "44px", sortable: true, number: true, hint: "Share of the matches that agree with the transform", cell: (row) => text.fixed(inlierRatio(row)) },
  { key: "translation_m", label: "Length", width: "56px", sortable: true, number: true, hint: "Translation of the link", cell: (row) => text.length(row.translation_m) },
  { key: "graph_distance", label: "Apart", width: "46px", sortable: true, number: true, hint: "Nodes from one end to the other along the path", cell: (row) => text.whole(row.graph_distance) },
  { key: "sessions", label: "Sessions", width: "56px", sortable: true, number: true, hint: "Of both ends", cell: ({ sessions: [a, b] }) => (a === b ? a : `${a} → ${b}`) },
  { key: "look_alike", label: "Alike", width: "48px", sortable: true, number: true, hint: "How likely the most similar place elsewhere in the map was, by this place: near 100 % it may be confused", cell: ({ look_alike: alike }) => (alike ? html`<span class=${cx(alike.share >= ALIKE && "ink-bad strong")}>${text.fixed(100 * alike.share, 0)} %</span>` : text.NONE) },
];
/** @type {import("./table.js").TableColumn<LoopRow>} */
const GNC = {
  key: "gnc",
  label: "GNC",
  width: "38px",
  sortable: true,
  number: true,
  hint: "How much graduated non-convexity lets it count: 0 where the rest of the graph contradicts it",
  cell: (row) => {
    const weight = weightOf(row);
    return html`<span class=${cx(weight !== null && weight < 0.5 && "ink-bad strong", weights.value?.stale && "quiet")}>${text.fixed(weight)}</span>`;
  },
};
/** Columns that make room for those, in this order; the evidence of a loop has their figures as well. */
const SPARED = ["type", "residual_sigma", "posterior"];
/** What the queue can be sorted by, as [key, label]. @type {[string, string][]} */
export const ORDERS = [["doubt", "Doubt"], ["residual_sigma", "Residual"], ["posterior", "Posterior"], ["inliers", "Inliers"], ["ratio", "Inlier ratio"], ["look_alike", "Look-alike"], ["gnc", "GNC weight"], ["translation_m", "Length"], ["graph_distance", "Nodes apart"], ["sessions", "Session"], ["from", "Node"], ["type", "Type"], ["state", "State"]];

/** @param {LoopRow} row */
export function inlierRatio({ inliers, matches }) {
  return inliers === null || !matches || matches < 0 ? null : inliers / matches;
}

/** @param {string} order @returns {import("./table.js").TableColumn<LoopRow>[]} */
export function loopColumns(order) {
  const sorted = order.replace("-", "");
  const more = [...(weights.value?.state === "done" ? [GNC] : []), ...MORE.filter(({ key }) => key === sorted)];
  const spared = SPARED.filter((key) => key !== sorted).slice(0, more.length);
  return [...standing().filter(({ key }) => !spared.includes(key)), ...more];
}

/** @returns {import("./table.js").TableColumn<LoopRow>[]} */
function standing() {
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
