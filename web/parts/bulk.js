// Decisions about all loops that are shown: approve or reject them together, once it is seen what that would do.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { deciding, decisionAsk } from "../actions.js";
import * as text from "../format.js";
import { Button } from "./button.js";
import { lockReason } from "./decision_bar.js";
import { EditDialog } from "./edit_dialog.js";

/** @typedef {import("../loop_list.js").LoopRow} LoopRow */
/** @typedef {"approve" | "reject"} Verdict */
/** @typedef {{from: number, to: number}} Pair */

/** @type {Record<Verdict, {verb: string, past: string, states: string[]}>} in these states there is nothing to say */
const VERDICTS = {
  approve: { verb: "Approve", past: "approved", states: ["approved", "added"] },
  reject: { verb: "Reject", past: "rejected", states: ["rejected"] },
};

/** @param {{rows: LoopRow[], total: number, onDecided: () => void}} props */
export function BulkBar({ rows, total, onDecided }) {
  const open = (/** @type {Verdict} */ action) => rows.filter(({ state }) => !VERDICTS[action].states.includes(state));
  const shown = rows.length === total ? `all ${text.whole(total)}` : `${text.whole(rows.length)} of ${text.whole(total)}`;
  const hint = (/** @type {Verdict} */ action) => `${VERDICTS[action].verb} every loop that is shown and isn't ${VERDICTS[action].past} yet; you see first what it would do`;
  return html`<div class="view-tools bulk">
    <span class="quiet small grow">${shown} shown</span>
    ${h(VerdictButton, { action: "approve", pairs: open("approve"), hint: hint("approve"), onDecided })}
    ${h(VerdictButton, { action: "reject", pairs: open("reject"), hint: hint("reject"), onDecided })}
  </div>`;
}

/** Asks about several loops at once. @param {{action: Verdict, pairs: Pair[], hint: string, onDecided: () => void}} props */
export function VerdictButton({ action, pairs, hint, onDecided }) {
  const [asked, setAsked] = useState(/** @type {Pair[] | null} */ (null));
  const locked = lockReason();
  const { verb, past } = VERDICTS[action];
  return html`${h(Button, {
    id: `${action}-all`,
    label: `${verb} ${text.whole(pairs.length)}…`,
    hint: locked ?? hint,
    disabled: !pairs.length || locked !== null || deciding.value,
    onClick: () => setAsked(pairs),
  })}
  ${asked &&
  h(EditDialog, {
    label: `${verb} loops`,
    heading: (said) => `${verb} ${text.plural(said?.count ?? asked.length, "loop")}?`,
    past: (said) => `${text.plural(said.count, "loop")} ${past}`,
    verb: (said) => `${verb} ${text.whole(said?.count ?? asked.length)}`,
    kind: action === "approve" ? "good" : "bad",
    ask: decisionAsk({ action, loops: asked.map(({ from, to }) => [from, to]) }),
    onDecided,
    onClose: () => setAsked(null),
  })}`;
}
