// The evidence of one link: both images with their matches, figures, why, and what to do about it.
import { h, html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { useKeys } from "../keys.js";
import { link as linkTo } from "../router.js";
import { graphRevision, inForce } from "../store.js";
import { weightOf, weights } from "../weights.js";
import { Belief } from "./belief.js";
import { DecisionBar } from "./decision_bar.js";
import { Facts } from "./facts.js";
import { LinkName } from "./link_name.js";
import { WalkLine, walkOn } from "./link_walk.js";
import { ALIKE, SUSPECT, sigmaText } from "./loop_columns.js";
import { MatchPicture } from "./matches.js";
import { Overlay } from "./overlay.js";
import { Poses } from "./pose.js";
import { Empty, Failed, Loading } from "./state.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["LinkDetail"]} LinkDetail */

/**
 * @typedef {object} EvidenceProps
 * @property {string} map
 * @property {string} link both ids, as 147-61
 * @property {import("../loop_list.js").LoopRow} [row] its row in the queue
 * @property {(by: number) => void} onStep
 * @property {() => void} onDecided
 * @property {unknown} [key]
 */

/** @param {EvidenceProps} props */
export function LinkEvidence({ map, link, row, onStep, onDecided }) {
  const [from, to] = link.split("-").map(Number);
  const { data, error, reload } = useFetched(
    (signal) => get("/api/maps/{map}/links/{from_id}/{to_id}/known", { path: { map, from_id: from, to_id: to }, signal }),
    [map, from, to],
  );
  useChanged(graphRevision, reload, 300);
  const found = data.value?.link ?? null;
  const decided = () => (reload(), onDecided());
  // A link that the queue does not list is walked along the path.
  const step = (/** @type {number} */ by) => (row ? onStep(by) : walkOn(found?.walk, by));
  useKeys(row ? {} : { j: () => step(1), k: () => step(-1) });
  if (error.value) return h(Failed, { error: error.value, what: `Link ${from} → ${to} can't be shown.`, onRetry: reload });
  if (data.value && !found) return h(NoLink, { from, to, note: data.value.note });
  // The row of the queue knows enough to decide before the evidence is here.
  const known = found ?? row;
  return html`<section class="evidence" aria-label=${`Link ${from} to ${to}`}>
    <div class="evidence-body">${found ? details(map, found) : h(Loading, {})}</div>
    ${h(DecisionBar, { from, to, state: known?.state ?? null, type: known?.type ?? null, measured: !found || found.transform !== null, onStep: step, onDecided: decided })}
  </section>`;
}

/** @param {{from: number, to: number, note: string}} props */
function NoLink({ from, to, note }) {
  const href = linkTo({ view: "loops", query: { tab: "link", from: String(from), to: String(to) } });
  return h(Empty, { icon: "loops", title: `There is no link ${from} → ${to}`, children: html`${note}. <a href=${href}>Link two nodes by hand</a>` });
}

/** @param {string} map @param {LinkDetail} found */
function details(map, found) {
  const { from, to, transform, update, posterior } = found;
  return html`${h(WalkLine, { walk: found.walk })}${h(MatchPicture, { map, from, to })}
    <p class=${`why why-${tone(found)}`} id="why">${found.explanation}</p>
    ${h(Overlay, { from, to, measured: transform !== null, scans: found.scans })}
    ${h(Facts, { facts: facts(found) })}
    ${transform && h(Poses, { rows: compared(found) })} ${found.problem && html`<p class="ink-bad small">${found.problem}</p>`}
    ${update !== null && posterior !== null && h(Belief, { map, update, place: from === update ? to : from })}
    ${found.covariance && covariance(found.covariance)}`;
}

/** What was measured beside what the graph made of it. @param {LinkDetail} found @returns {[string, import("./pose.js").Pose, string?][]} */
function compared({ transform, optimized, off, off_m, off_deg }) {
  const apart = off ? `${text.length(off_m)} and ${text.fixed(off_deg, 2)} ° apart` : undefined;
  return [
    ["Measured", transform, "As the link has it"],
    ["Optimised", optimized, "As the optimised poses have it"],
    ["Apart", off, apart],
  ];
}

const AXES = ["x", "y", "z", "roll", "pitch", "yaw"];

/** All 36 numbers, for those who ask. @param {number[][]} rows */
function covariance(rows) {
  const number = (/** @type {number} */ value) => (value === 0 ? "0" : value.toExponential(1).replaceAll("-", "−"));
  return html`<details class="fold covariance">
    <summary>Covariance 6×6 <span class="quiet small">m², rad²</span></summary>
    <table class="small">
      <thead><tr><th></th>${AXES.map((axis) => html`<th key=${axis} scope="col">${axis}</th>`)}</tr></thead>
      <tbody>${rows.map((row, i) => html`<tr key=${AXES[i]}><th scope="row">${AXES[i]}</th>${row.map((value, k) => html`<td key=${k} title=${String(value)}>${number(value)}</td>`)}</tr>`)}</tbody>
    </table>
  </details>`;
}

/** @param {LinkDetail} found @returns {import("./facts.js").Fact[]} */
function facts(found) {
  const { from, to, type, transform, sigma_m: sigma, sigma_deg: sigmaDeg, posterior, inliers, matches } = found;
  const node = (/** @type {number} */ id) => html`<a href=${linkTo({ view: "nodes", key: id })}>${id}</a>`;
  const loopThr = Number(inForce("Rtabmap/LoopThr") ?? NaN);
  const enough = posterior !== null && posterior >= loopThr ? "≥" : "<";
  const weight = weightOf(found);
  const { doubt, chi2_share: share, look_alike: alike } = found;
  return [
    ["Link", html`${node(from)} → ${node(to)} ${h(LinkName, { type })}`],
    ["P", posterior === null ? text.NONE : `${text.fixed(posterior)} ${enough} ${text.short(loopThr)} LoopThr`],
    ["Inliers", matches === null || matches < 0 ? text.NONE : `${inliers} of ${matches}`],
    ["Sigma", sigma ? `${text.length(Math.max(...sigma))} · ${text.fixed(Math.max(...(sigmaDeg ?? [])), 2)} °` : text.NONE, "Largest of the three axes"],
    ["Residual", found.residual_sigma === null ? text.NONE : `${sigmaText(found.residual_sigma)} σ`],
    ["χ²", found.chi2 === null ? text.NONE : chi2Text(found.chi2, share), "Its squared residual, and its share of the whole graph's"],
    ["Odometry", doubt?.odometry == null ? text.NONE : `${sigmaText(doubt.odometry)} σ away`, "How far odometry alone is from this transform"],
    ["Near by", doubt?.compared ? `${doubt.agreeing} of ${doubt.compared} loops agree` : text.NONE, "Loops near by, each with the odometry between"],
    ["Look-alike", alike ? html`node ${node(alike.node)}, <span class=${alike.share >= ALIKE ? "ink-bad strong" : ""}>${text.fixed(100 * alike.share, 0)} %</span>` : text.NONE, alike ? `The place elsewhere that rivals it most, ${text.length(alike.distance_m)} away, and how likely it was by this place` : "No place elsewhere in the map rivals it"],
    ...(weight === null ? [] : [/** @type {import("./facts.js").Fact} */ (["GNC", html`weight <b class=${weight < 0.5 ? "ink-bad" : ""}>${text.fixed(weight)}</b>${weights.value?.stale ? " before the last change" : ""}`, "How much graduated non-convexity lets it count"])]),
    ["Moved", found.off_m === null ? text.NONE : `${text.length(found.off_m)} · ${text.fixed(found.off_deg, 2)} °`, "How far the optimised transform is from the measured one"],
    ...attached(found),
    ["Distance", transform ? `${text.length(found.translation_m)} · ${text.fixed(found.rotation_deg, 1)} °` : text.NONE],
  ];
}

/** What is stored with it besides. @param {LinkDetail} found @returns {import("./facts.js").Fact[]} */
function attached({ merged_scans: scans, user_data: data }) {
  if (scans.length) return [["Scans", html`<span class="clip" title=${`Nodes ${scans.join(", ")}`}>of ${text.plural(scans.length, "node")}: ${scans.join(", ")}</span>`, "Their scans were put together to make it"]];
  if (!data) return [];
  return [["User data", data.text ?? `${data.rows} × ${data.columns} ${data.type}, ${text.size(data.bytes)}`]];
}

/** @param {number} chi2 @param {number | null} share */
function chi2Text(chi2, share) {
  const size = chi2 >= 1000 ? text.whole(Math.round(chi2)) : sigmaText(chi2);
  return share === null ? size : `${size} (${text.fixed(100 * share, 0)} %)`;
}

/** @param {LinkDetail} found */
function tone({ state, doubt }) {
  if (doubt !== null && doubt.score >= SUSPECT && state === "accepted") return "bad";
  if (state === "refused" || state === "rejected") return "bad";
  return state === "accepted" || state === "approved" || state === "added" ? "good" : "quiet";
}
