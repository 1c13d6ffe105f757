// The same picture, as large as the window.
import { useEffect, useRef } from "preact/hooks";
import { h, html } from "../html.js";
import { Button } from "./button.js";

/** @param {{title: string, close: () => void, children: import("../html.js").Children}} props */
export function Lightbox({ title, close, children }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  useEffect(() => dialog.current?.showModal(), []);
  return html`<dialog
    ref=${dialog}
    class="lightbox"
    aria-label=${title}
    onClose=${close}
    onClick=${(/** @type {Event} */ event) => event.target === dialog.current && close()}
  >
    <header><b class="grow">${title}</b>${h(Button, { icon: "close", hint: "Close (Esc)", onClick: close })}</header>
    <div class="lightbox-body">${children}</div>
  </dialog>`;
}
