// Approve, reject, undo, next: the buttons, their keys, and what the last decision did to the graph.
import { h, html } from "../html.js";
import { decide, deciding, lastDecision, say } from "../actions.js";
import * as text from "../format.js";
import { useKeys } from "../keys.js";
import { openMapId } from "../router.js";
import { info, session } from "../store.js";
import { Button } from "./button.js";

/** @typedef {import("../store.js").Schemas["DecisionEffect"]} Effect */

/**
 * @typedef {object} DecisionBarProps
 * @property {number} from
 * @property {number} to
 * @property {string | null} state null while it isn't known
 * @property {string | null} type
 * @property {boolean} measured whether there is a transform to approve
 * @property {(by: number) => void} onStep
 * @property {() => void} onDecided
 */

/** @param {DecisionBarProps} props */
export function DecisionBar({ from, to, state, type, measured, onStep, onDecided }) {
  const busy = deciding.value;
  const locked = lockReason();
  const run = async (/** @type {"approve" | "reject" | "undo"} */ action) => {
    if (locked) return;
    if (await decide(action === "undo" ? { action } : { action, from, to })) onDecided();
  };
  const isLoop = type !== null && /Closure$/.test(type);
  const canApprove = isLoop && measured && state !== "approved" && state !== "added";
  // One without a state was only tried to see what another threshold would mean: it can come, there is nothing to go.
  const canReject = isLoop && state !== null && state !== "rejected" && state !== "refused";
  const nothing = (/** @type {"approve" | "reject"} */ action) => say(`${from} → ${to}: ${whyNothing(action, { state, isLoop, measured })}`);
  useKeys({
    a: () => void (locked ? say(locked) : canApprove ? run("approve") : nothing("approve")),
    r: () => void (locked ? say(locked) : canReject ? run("reject") : nothing("reject")),
  });
  return html`<footer class="decisions">
    ${h(EffectLine, {})}
    <div class="decision-buttons">
      ${h(Button, { id: "approve", label: "Approve", keys: "A", kind: "good", hint: locked ?? (measured ? (state === null ? "Only tried for the what-if so far; put it into the map" : "This loop is right") : "Verification found no transform that could be approved"), disabled: busy || !canApprove || !!locked, onClick: () => void run("approve") })}
      ${h(Button, { id: "reject", label: "Reject", keys: "R", kind: "bad", hint: locked ?? "Take this loop out of the graph", disabled: busy || !canReject || !!locked, onClick: () => void run("reject") })}
      ${h(Button, { id: "undo", label: "Undo", keys: "U", hint: locked ?? "Take the last decision back; Shift U makes it again", disabled: busy || !!locked, onClick: () => void run("undo") })}
      ${h(Button, { id: "previous", label: "Prev", keys: "K", onClick: () => onStep(-1) })}
      ${h(Button, { id: "next", label: "Next", keys: "J", onClick: () => onStep(1) })}
    </div>
  </footer>`;
}

/**
 * What is said when a key finds nothing to decide.
 * @param {"approve" | "reject"} action
 * @param {{state: string | null, isLoop: boolean, measured: boolean}} link
 */
export function whyNothing(action, { state, isLoop, measured }) {
  if (!isLoop) return "only loops can be approved or rejected; this link is none";
  if (state === "approved" || state === "added") return "it is in the map by a person's decision already; U takes that back";
  if (state === "rejected") return "it is rejected already; A puts it back, U takes the decision back";
  if (action === "reject") return "it is not in the graph, so that there is nothing to reject";
  return measured ? "its evidence is on its way" : "verification found no transform that could be approved; Link makes one by hand";
}

/** Why nobody can decide now; null where one can. */
export function lockReason() {
  const locked = info.value !== null && !info.value.writable;
  return locked ? "Another program holds this map for writing, or the file is read-only" : null;
}

/** Whether an engine makes the open map now. */
export function isMade() {
  const run = session.value;
  return run?.map != null && run.map === openMapId.value && ["starting", "running", "paused"].includes(run.state);
}

/** Why no node can leave the map and no job can work on it now; null where they can. */
export function stopReason() {
  return lockReason() ?? (isMade() ? "The engine that makes this map holds its nodes in memory: stop the run first; pausing it is not enough" : null);
}

/** What the last decision made here did. */
export function EffectLine() {
  const last = lastDecision.value?.map === openMapId.value ? lastDecision.value?.made : null;
  if (deciding.value) return html`<p class="effect" role="status">Optimising the graph…</p>`;
  if (!last) return null;
  const { entry, effect, count } = last;
  const one = entry.of_map ? "" : entry.from_id === entry.to_id ? ` node ${entry.from_id}` : ` ${entry.from_id} → ${entry.to_id}`;
  const name = count > 1 ? ` ${text.whole(count)} ${THINGS[entry.action] ?? "entries"}` : one;
  const note = last.note && html`<span class="ink-warn">${last.note}</span>`;
  return html`<p class="effect" role="status" id="effect"><span class="quiet">${done(entry)}${name}</span> ${effectParts(effect)} ${note}</p>`;
}

/** @type {Record<string, string>} */
export const PAST = {
  approve: "Approved",
  reject: "Rejected",
  undo: "Undid",
  redo: "Redid",
  add: "Added",
  refine: "Refined",
  edit: "Changed",
  reset: "Reset",
  cut: "Cut",
  bridge: "Bridged",
  drop: "Removed",
  prior: "Prior of",
  covariance: "Covariance of",
  label: "Labelled",
  optimise: "Kept other poses",
  turn: "Turned the map",
  regrid: "Made local grids anew",
};

/** What was done, and for the way back to what. @param {import("../store.js").Schemas["JournalEntry"]} entry */
export function done({ action, of_map: ofMap }) {
  return `${PAST[action] ?? action}${ofMap && ["undo", "redo"].includes(action) ? " a decision about the map" : ""}`;
}
/** What several entries of an action are about. @type {Record<string, string>} */
export const THINGS = { approve: "loops", reject: "loops", add: "loops", refine: "links", edit: "links", reset: "links", covariance: "links", label: "nodes" };

/** @param {number | null} chi2 */
export function chi2Text(chi2) {
  return chi2 !== null && chi2 >= 1000 ? text.whole(chi2) : text.fixed(chi2, 1);
}

/** What comes, goes and changes; nothing where that is said by the effect alone. @param {import("../store.js").Schemas["Changes"]} changes */
export function changeParts(changes) {
  /** @type {[number, string, string][]} */
  const all = [
    [changes.nodes_gone, "node", "leaving"],
    [changes.nodes_back, "node", "coming back"],
    [changes.loops_gone, "loop", "lost"],
    [changes.loops_new, "loop", "added"],
    [changes.links_gone, "other link", "cut"],
    [changes.links_new, "bridge", "over the gap"],
    [changes.priors_gone, "prior", "removed"],
    [changes.priors_new, "prior", "added"],
    [changes.changed, "link", "changed"],
  ];
  const parts = all.filter(([count]) => count);
  if (!parts.length) return null;
  return html`<p class="bulk-effect" id="bulk-changes">${parts.map(([count, thing, what]) => html`<span key=${thing + what}><b>${text.plural(count, thing)}</b> ${what}</span>`)}</p>`;
}

/** @param {Effect} effect */
export function effectParts(effect) {
  const ate = effect.ate_before_m ?? null;
  return html`<span class="effect-parts">
    <span>χ² <b>${chi2Text(effect.chi2_before)} → ${chi2Text(effect.chi2_after)}</b></span>
    <span>moved <b>${text.plural(effect.moved, "pose")}</b>, max <b>${text.length(effect.max_shift_m)}</b></span>
    ${Boolean(effect.separated) && html`<span class="ink-bad">cut off <b>${text.plural(effect.separated ?? 0, "node")}</b></span>`}
    ${ate !== null && html`<span>ATE <b>${text.length(ate)} → ${text.length(effect.ate_after_m)}</b></span>`}
  </span>`;
}
