// The face of the what-if: a threshold, the loops that would come and go, and what the map would be like.
import { useEffect, useState } from "preact/hooks";
import { cx, h, html } from "../html.js";
import { setParameters } from "../actions.js";
import { draft, foresee, foreseeError, foreseen, leave, mostPending, tryOut } from "../draft.js";
import * as text from "../format.js";
import { go } from "../router.js";
import { graphRevision, inForce } from "../store.js";
import { VerdictButton } from "./bulk.js";
import { isMade, lockReason } from "./decision_bar.js";
import { Badge, Facts } from "./facts.js";
import { Button, Chip } from "./button.js";
import { Empty, Failed, Loading } from "./state.js";
import { Table } from "./table.js";
import { useChanged } from "./use.js";

/** @typedef {import("../draft.js").WhatIf} WhatIf */
/** @typedef {WhatIf["loops"][number]} Loop */

const LOOP_THR = "Rtabmap/LoopThr";
/** @type {Record<string, [import("./facts.js").Tone, string, string]>} outcome -> tone, word, meaning */
const OUTCOMES = {
  comes: ["accent", "comes", "It would reach the threshold, and images and graph agree with it"],
  goes: ["bad", "goes", "It would not reach the threshold"],
  refused: ["quiet", "refused", "It would reach the threshold, and images or graph speak against it"],
  untried: ["warn", "trying", "Its images are being compared now"],
  stays: ["good", "stays", "It is in the map and would stay"],
};
const RANK = Object.keys(OUTCOMES);

/** @param {{map: string, selected: string | null}} props */
export function WhatIfPanel({ map, selected }) {
  const now = Number(inForce(LOOP_THR) ?? NaN);
  const [outcomes, setOutcomes] = useState(["comes", "goes", "refused", "untried"]);
  const [order, setOrder] = useState("outcome");
  useEffect(() => leave, [map]);
  useEffect(() => void (Number.isFinite(now) && draft.value === null && tryOut(now)), [map, now]);
  useChanged(graphRevision, () => void foresee());
  const found = foreseen.value;
  if (!found) return foreseeError.value ? h(Failed, { error: foreseeError.value, what: "This can't be foreseen.", onRetry: () => void foresee() }) : h(Loading, {});
  const rows = found.loops.filter(({ outcome }) => outcomes.includes(outcome)).sort(by(order));
  const toggle = (/** @type {string} */ one, /** @type {boolean} */ on) => setOutcomes(on ? [...outcomes, one] : outcomes.filter((other) => other !== one));
  return html`<div class="view-part what-if">
    ${h(Threshold, { now })}
    <div class="view-tools filters" role="group" aria-label="Outcome">
      ${RANK.filter((one) => found.counts[one] || one === "comes" || one === "goes").map((one) =>
        h(Chip, { key: one, label: `${OUTCOMES[one][1]} ${text.whole(found.counts[one])}`, hint: OUTCOMES[one][2], on: outcomes.includes(one), onChange: (on) => toggle(one, on) }),
      )}
    </div>
    ${h(Verdicts, { found })}
    <div class="what-if-facts">${h(Progress, { found })}${h(Facts, { facts: facts(found) })}</div>
    <div class="view-table">
      ${rows.length
        ? h(/** @type {typeof Table<Loop>} */ (Table), {
            label: "Foreseen loops",
            columns: columns(),
            total: rows.length,
            rowAt: (index) => rows[index],
            selected: rows.findIndex(({ key }) => key === selected),
            onSelect: (index) => go({ view: "loops", key: rows[index].key, query: { tab: "what-if" } }),
            order,
            onOrder: setOrder,
          })
        : h(Empty, { icon: "loops", title: found.loops.length ? "No loop would come or go" : "No update of this map had a hypothesis", children: found.loops.length ? `Move the threshold, or drag its line in the chart of the hypothesis.` : "What-if needs the loop hypotheses that a run stores." })}
    </div>
  </div>`;
}

/** @param {{now: number}} props */
function Threshold({ now }) {
  const value = draft.value ?? now;
  const live = isMade();
  const locked = live ? null : lockReason();
  const apply = async () => void ((await setParameters({ [LOOP_THR]: value })) && foresee());
  const set = (/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => currentTarget.value !== "" && tryOut(Number(currentTarget.value));
  return html`<div class="what-if-threshold">
    <label for="what-if-slider">${LOOP_THR}</label>
    <input id="what-if-slider" type="range" min="0" max="1" step="0.005" value=${value} style=${{ "--filled": `${100 * value}%` }} onInput=${set} />
    <input class="field number" type="number" aria-label="Threshold" min="0" max="1" step="0.01" value=${value} onChange=${set} />
    ${h(Button, { icon: "reset", kind: "bare", hint: `Back to the value in force, ${text.short(now)}`, disabled: value === now, onClick: () => tryOut(now) })}
    ${h(Button, {
      id: "what-if-apply",
      label: "Apply",
      kind: "accent",
      hint: locked ?? (live ? "Set it in the running engine, from the next frame on" : "Set it in the map: what a session that goes on with it begins with. Its loops stay; approve or reject those below"),
      disabled: locked !== null || value === now,
      onClick: () => void apply(),
    })}
  </div>`;
}

/** The loops that would come and go, decided at once. @param {{found: WhatIf}} props */
function Verdicts({ found }) {
  const of = (/** @type {string} */ wanted) => found.loops.filter(({ outcome }) => outcome === wanted);
  const [coming, going] = [of("comes"), of("goes")];
  if (!coming.length && !going.length) return null;
  const decided = () => void foresee();
  return html`<div class="view-tools bulk">
    <span class="quiet small grow">Decide it by hand</span>
    ${coming.length > 0 && h(VerdictButton, { action: "approve", pairs: coming, hint: "Put the loops that would come into the map; you see first what it would do", onDecided: decided })}
    ${going.length > 0 && h(VerdictButton, { action: "reject", pairs: going, hint: "Take the loops that would go out of the map; you see first what it would do", onDecided: decided })}
  </div>`;
}

/** @param {{found: WhatIf}} props */
function Progress({ found: { pending } }) {
  if (!pending) return null;
  const most = Math.max(mostPending.value, pending);
  return html`<p class="what-if-progress small" role="status">
    <progress max=${most} value=${most - pending}></progress>
    Comparing images of ${text.plural(pending, "hypothesis", "hypotheses")} that ${pending === 1 ? "was" : "were"} never tried
  </p>`;
}

/** @param {WhatIf} found @returns {import("./facts.js").Fact[]} */
function facts({ graph, precision, recall, ate_now_m: now }) {
  const share = (/** @type {number | null} */ value) => (value === null ? text.NONE : `${text.fixed(100 * value, 1)} %`);
  const off = graph && graph.stored_off_m > 0.001 ? `. The stored poses are up to ${text.length(graph.stored_off_m)} off the optimum of the same loops` : "";
  const moved = graph ? `${text.plural(graph.moved, "pose")}, max ${text.length(graph.max_shift_m)}` : text.NONE;
  const same = graph?.ate_m != null && now !== null && Math.abs(graph.ate_m - now) < 5e-5;
  return [
    ["Precision", share(precision), "Of the loops that would be in the map and have a label, by ground truth or a person, the share of true ones"],
    ["Moved", moved, `Poses that would move by more than 1 mm or 0.05 degrees from the optimum as it is${off}`],
    ["Recall", share(recall), "Of the true loops that are known, the share that would be in the map"],
    ["ATE", now === null ? text.NONE : graph ? html`${text.length(now)} → <b class=${cx(!same && (Number(graph.ate_m) > now ? "ink-bad" : "ink-good"))}>${text.length(graph.ate_m)}</b>` : text.length(now), "Trajectory error at the optimum as it is, and as it would be"],
  ];
}

/** @returns {import("./table.js").TableColumn<Loop>[]} */
function columns() {
  return [
    { key: "outcome", label: "Outcome", width: "60px", sortable: true, cell: ({ outcome }) => h(Badge, { tone: OUTCOMES[outcome][0], hint: OUTCOMES[outcome][2], children: OUTCOMES[outcome][1] }) },
    { key: "from", label: "Nodes", width: "86px", sortable: true, cell: ({ from, to }) => html`${from} <span class="quiet">→</span> ${to}` },
    { key: "value", label: "P", width: "38px", sortable: true, number: true, hint: "What the threshold is compared with", cell: ({ value }) => text.fixed(value, 3) },
    { key: "true", label: "True", width: "30px", sortable: true, hint: "What ground truth or a person says of it", cell: ({ true: is }) => (is === null ? html`<span class="quiet">?</span>` : html`<span class=${is ? "ink-good" : "ink-bad strong"}>${is ? "yes" : "no"}</span>`) },
    { key: "inliers", label: "Inliers, or why not", width: "minmax(120px, 1fr)", sortable: true, hint: "Sorted by inliers", cell: ({ inliers, reason }) => html`<span class="why-cell quiet" title=${reason}>${reason || (inliers === null ? text.NONE : text.plural(inliers, "inlier"))}</span>` },
  ];
}

/** @param {string} order @returns {(a: Loop, b: Loop) => number} */
function by(order) {
  const key = /** @type {keyof Loop} */ (order.replace("-", ""));
  const sign = order.startsWith("-") ? -1 : 1;
  const value = (/** @type {Loop} */ loop) => (key === "outcome" ? RANK.indexOf(loop.outcome) : Number(loop[key] ?? -1));
  return (a, b) => sign * (value(a) - value(b)) || b.value - a.value;
}
