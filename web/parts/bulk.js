// Decisions about all loops that the queue shows: what they would do, before anything is done.
import { useEffect, useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { decide, deciding, foreseeDecision } from "../actions.js";
import * as text from "../format.js";
import { Author } from "./author.js";
import { Button } from "./button.js";
import { effectParts, lockReason } from "./decision_bar.js";
import { Failed, Loading } from "./state.js";
import { useFetched } from "./use.js";

/** @typedef {import("../loop_list.js").LoopRow} LoopRow */
/** @typedef {import("../store.js").Schemas["DecisionResult"]} Result */
/** @typedef {"approve" | "reject"} Verdict */

/** @type {Record<Verdict, {verb: string, past: string, states: string[]}>} in these states there is nothing to say */
const VERDICTS = {
  approve: { verb: "Approve", past: "approved", states: ["approved", "added"] },
  reject: { verb: "Reject", past: "rejected", states: ["rejected"] },
};
const MOST_NAMED = 6;

/** @param {{rows: LoopRow[], total: number, onDecided: () => void}} props */
export function BulkBar({ rows, total, onDecided }) {
  const [asked, setAsked] = useState(/** @type {{action: Verdict, rows: LoopRow[]} | null} */ (null));
  const locked = lockReason();
  const shown = rows.length === total ? `all ${text.whole(total)}` : `${text.whole(rows.length)} of ${text.whole(total)}`;
  const ask = (/** @type {Verdict} */ action) => {
    const open = rows.filter(({ state }) => !VERDICTS[action].states.includes(state));
    return h(Button, {
      id: `${action}-all`,
      label: `${VERDICTS[action].verb} ${text.whole(open.length)}…`,
      hint: locked ?? `${VERDICTS[action].verb} every loop that is shown and isn't ${VERDICTS[action].past} yet; you see first what it would do`,
      disabled: !open.length || locked !== null || deciding.value,
      onClick: () => setAsked({ action, rows: open }),
    });
  };
  return html`<div class="view-tools bulk">
    <span class="quiet small grow">${shown} shown</span>${ask("approve")}${ask("reject")}
    ${asked && h(BulkDialog, { ...asked, onDecided, onClose: () => setAsked(null) })}
  </div>`;
}

/** @param {{action: Verdict, rows: LoopRow[], onDecided: () => void, onClose: () => void}} props */
function BulkDialog({ action, rows, onDecided, onClose }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  const [done, setDone] = useState(/** @type {Result | null} */ (null));
  const decision = { action, loops: rows.map(({ from, to }) => [from, to]) };
  const { data, error, reload } = useFetched((signal) => foreseeDecision(decision, signal), [action]);
  useEffect(() => dialog.current?.showModal(), []);
  const carryOut = async () => {
    const answer = await decide(decision);
    if (answer) (setDone(answer), onDecided());
  };
  const undo = async () => void ((await decide({ action: "undo" })) && (onDecided(), onClose()));
  const { verb, past } = VERDICTS[action];
  const said = done ?? data.value;
  const count = said?.count ?? rows.length;
  return html`<dialog
    ref=${dialog}
    class="bulk-dialog"
    aria-label=${`${verb} loops`}
    onClose=${onClose}
    onClick=${(/** @type {Event} */ event) => event.target === dialog.current && !deciding.value && onClose()}
  >
    <h2>${done ? `${text.plural(count, "loop")} ${past}` : `${verb} ${text.plural(count, "loop")}?`}</h2>
    <div class="bulk-body" role="status" id="bulk-effect">
      ${error.value
        ? h(Failed, { error: error.value, what: "This can't be done.", onRetry: reload })
        : said
          ? html`<p>${done ? "It did this:" : "It would do this; nothing is changed yet."}</p>
              <p class="bulk-effect">${effectParts(said.effect)}</p>
              ${refusals(said)}`
          : html`<p>Working out what it would do…</p>${h(Loading, {})}`}
    </div>
    <footer class="bulk-buttons">
      ${done ? null : h(Author, {})}<span class="grow"></span>
      ${done
        ? [h(Button, { id: "bulk-undo", label: "Undo all", disabled: deciding.value, onClick: () => void undo() }), h(Button, { label: "Close", kind: "accent", onClick: onClose })]
        : [
            h(Button, { label: "Cancel", onClick: onClose }),
            h(Button, {
              id: "bulk-do",
              label: deciding.value ? "Optimising…" : `${verb} ${text.whole(count)}`,
              kind: action === "approve" ? "good" : "bad",
              disabled: !data.value || deciding.value,
              onClick: () => void carryOut(),
            }),
          ]}
    </footer>
  </dialog>`;
}

/** What stays as it is, and why. @param {Result} result */
function refusals({ refused, preview }) {
  if (!refused.length) return null;
  const more = refused.length - MOST_NAMED;
  return html`<div class="note bulk-note">
    ${text.plural(refused.length, "loop")} ${preview ? "would stay" : refused.length === 1 ? "stays" : "stay"} as before:
    <ul>
      ${refused.slice(0, MOST_NAMED).map(({ from, to, reason }) => html`<li key=${`${from}-${to}`}>${reason}</li>`)}
      ${more > 0 && html`<li>and ${text.whole(more)} more</li>`}
    </ul>
  </div>`;
}
