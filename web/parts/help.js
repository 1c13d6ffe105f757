// The list of keys.
import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { h, html } from "../html.js";
import { Button } from "./button.js";

const KEYS = /** @type {[string, [string, string][]][]} */ ([
  ["Page", [["Ctrl K", "search or command"], ["1 … 6", "maps, nodes, loops, params, stats, graph"], ["T", "light or dark"], ["?", "this list"]]],
  ["Run", [["Space", "pause or resume"], [".", "one frame"]]],
  ["Loops", [["J / K", "next, previous"], ["A", "approve"], ["R", "reject"], ["U", "undo the last decision"], ["⇧ U", "redo it"], ["E", "larger images"]]],
  ["Two nodes", [["J / K", "next, previous of A"], ["⇧ J / ⇧ K", "of B"], ["X", "change places"]]],
  ["Timeline", [["← →", "previous, next update"], ["Shift ← →", "previous, next event"], ["P", "play or pause"], ["N", "now"]]],
  ["Tables", [["↑ ↓", "next, previous row"], ["Home End", "first, last row"]]],
  ["Areas", [["← →  ↑ ↓", "resize, on a focused bar"]]],
]);

const shown = signal(false);

export function showHelp() {
  shown.value = true;
}

export function Help() {
  return shown.value ? h(Dialog, { close: () => (shown.value = false) }) : null;
}

/** @param {{close: () => void}} props */
function Dialog({ close }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  useEffect(() => dialog.current?.showModal(), []);
  return html`<dialog
    ref=${dialog}
    class="help"
    aria-label="Keyboard shortcuts"
    onClose=${close}
    onClick=${(/** @type {Event} */ event) => event.target === dialog.current && close()}
  >
    <header><h2 class="grow">Keyboard</h2>${h(Button, { icon: "close", hint: "Close (Esc)", kind: "bare", onClick: close })}</header>
    <div class="help-groups">
      ${KEYS.map(
        ([group, keys]) => html`<section key=${group}>
          <h3>${group}</h3>
          <dl>${keys.map(([key, meaning]) => html`<div key=${key}><dt><kbd>${key}</kbd></dt><dd>${meaning}</dd></div>`)}</dl>
        </section>`,
      )}
    </div>
  </dialog>`;
}
