// Approve, reject, undo, next: the buttons, their keys, and what the last decision did to the graph.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { decide, lastDecision } from "../actions.js";
import * as text from "../format.js";
import { useKeys } from "../keys.js";
import { info } from "../store.js";
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
  const [busy, setBusy] = useState(false);
  const locked = info.value && !info.value.writable ? "Another program holds this map for writing, or the file is read-only" : null;
  const run = async (/** @type {"approve" | "reject" | "undo" | "redo"} */ action) => {
    if (busy || locked) return;
    setBusy(true);
    const about = action === "approve" || action === "reject" ? { from, to } : {};
    if (await decide({ action, ...about })) onDecided();
    setBusy(false);
  };
  const isLoop = type !== null && /Closure$/.test(type);
  const canApprove = isLoop && measured && state !== "approved" && state !== "added";
  const canReject = isLoop && state !== "rejected" && state !== "refused";
  useKeys({
    a: () => void (canApprove && run("approve")),
    r: () => void (canReject && run("reject")),
    u: () => void run("undo"),
  });
  return html`<footer class="decisions">
    ${h(EffectLine, { busy })}
    <div class="decision-buttons">
      ${h(Button, { id: "approve", label: "Approve", keys: "A", kind: "good", hint: locked ?? (measured ? "This loop is right" : "Verification found no transform that could be approved"), disabled: busy || !canApprove || !!locked, onClick: () => void run("approve") })}
      ${h(Button, { id: "reject", label: "Reject", keys: "R", kind: "bad", hint: locked ?? "Take this loop out of the graph", disabled: busy || !canReject || !!locked, onClick: () => void run("reject") })}
      ${h(Button, { id: "undo", label: "Undo", keys: "U", hint: locked ?? "Take the last decision back", disabled: busy || !!locked, onClick: () => void run("undo") })}
      ${h(Button, { id: "previous", label: "Prev", keys: "K", onClick: () => onStep(-1) })}
      ${h(Button, { id: "next", label: "Next", keys: "J", onClick: () => onStep(1) })}
    </div>
  </footer>`;
}

/** @param {{busy: boolean}} props */
function EffectLine({ busy }) {
  const last = lastDecision.value;
  if (busy) return html`<p class="effect" role="status">Optimising the graph…</p>`;
  if (!last) return null;
  const { entry, effect } = last;
  const name = entry.from_id ? ` ${entry.from_id} → ${entry.to_id}` : "";
  return html`<p class="effect" role="status" id="effect"><span class="quiet">${PAST[entry.action] ?? entry.action}${name}</span> ${effectParts(effect)}</p>`;
}

/** @type {Record<string, string>} */
export const PAST = { approve: "Approved", reject: "Rejected", undo: "Undid", redo: "Redid", add: "Added" };

/** @param {Effect} effect */
export function effectParts(effect) {
  const ate = effect.ate_before_m ?? null;
  return html`<span class="effect-parts">
    <span>χ² <b>${text.fixed(effect.chi2_before, 1)} → ${text.fixed(effect.chi2_after, 1)}</b></span>
    <span>moved <b>${text.plural(effect.moved, "pose")}</b>, max <b>${text.length(effect.max_shift_m)}</b></span>
    ${ate !== null && html`<span>ATE <b>${text.length(ate)} → ${text.length(effect.ate_after_m)}</b></span>`}
  </span>`;
}
