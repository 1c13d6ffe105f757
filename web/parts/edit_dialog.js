// A decision about many things: what it would do, before anything is done; then what it did, and the way back.
import { useEffect, useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { decide, deciding } from "../actions.js";
import * as text from "../format.js";
import { Author } from "./author.js";
import { Button } from "./button.js";
import { changeParts, effectParts } from "./decision_bar.js";
import { Failed, Loading } from "./state.js";
import { useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["DecisionResult"]} Result */
/** @typedef {import("../actions.js").Ask} Ask */

/**
 * @typedef {object} EditDialogProps
 * @property {string} label of the dialog
 * @property {(said: Result | null) => string} heading what is asked, with the number where it is known
 * @property {(said: Result) => string} past what was done
 * @property {(said: Result | null) => string} verb on the button that does it
 * @property {"good" | "bad" | "accent"} kind
 * @property {Ask} ask
 * @property {() => void} onDecided
 * @property {() => void} onClose
 */

const MOST_NAMED = 6;

/** @param {EditDialogProps} props */
export function EditDialog({ label, heading, past, verb, kind, ask, onDecided, onClose }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  const [done, setDone] = useState(/** @type {Result | null} */ (null));
  const { data, error, reload } = useFetched((signal) => ask.foresee(signal), [label]);
  useEffect(() => dialog.current?.showModal(), []);
  const carryOut = async () => {
    const answer = await ask.carryOut();
    if (answer) (setDone(answer), onDecided());
  };
  const undo = async () => void ((await decide({ action: "undo" })) && (onDecided(), onClose()));
  const said = done ?? data.value;
  return html`<dialog
    ref=${dialog}
    class="bulk-dialog"
    aria-label=${label}
    onClose=${onClose}
    onClick=${(/** @type {Event} */ event) => event.target === dialog.current && !deciding.value && onClose()}
  >
    <h2>${done ? past(done) : heading(said)}</h2>
    <div class="bulk-body" role="status" id="bulk-effect">
      ${error.value
        ? h(Failed, { error: error.value, what: "This can't be done.", onRetry: reload })
        : said
          ? html`<p>${done ? "It did this:" : "It would do this; nothing is changed yet."}</p>
              ${changeParts(said.changes)}
              <p class="bulk-effect">${effectParts(said.effect)}</p>
              ${said.note && html`<p class="note">${said.note}.</p>`} ${refusals(said)}`
          : html`<p>Working out what it would do…</p>${h(Loading, {})}`}
    </div>
    <footer class="bulk-buttons">
      ${done ? null : h(Author, {})}<span class="grow"></span>
      ${done
        ? [h(Button, { id: "bulk-undo", label: "Undo all", disabled: deciding.value, onClick: () => void undo() }), h(Button, { label: "Close", kind: "accent", onClick: onClose })]
        : [
            h(Button, { label: "Cancel", onClick: onClose }),
            h(Button, { id: "bulk-do", label: deciding.value ? "Optimising…" : verb(said), kind, disabled: !data.value || deciding.value, onClick: () => void carryOut() }),
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
