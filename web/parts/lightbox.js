// The same picture, as large as the window.
import { useEffect, useRef } from "preact/hooks";
import { h, html } from "../html.js";
import { say } from "../actions.js";
import { openMapId } from "../router.js";
import { savePictures } from "../save.js";
import { Button } from "./button.js";
import { pictureOf } from "./canvas.js";

/** Save the pictures in a part of the page, beside each other. @param {HTMLElement | null} part @param {string} title */
export function saveShown(part, title) {
  const shown = [...(part?.querySelectorAll("canvas") ?? [])];
  if (!shown.length || shown.some((one) => one.ariaBusy === "true")) return say("The pictures are still on their way; save them when they show.");
  savePictures(shown.map(pictureOf), `${openMapId.value} ${title}.png`);
}

/** Width / height of two ordinary images side by side. */
const PAIR = 8 / 3;

/**
 * @typedef {object} LightboxProps
 * @property {string} title
 * @property {number} [aspect] of the picture, which has to fit the window
 * @property {boolean} [savable]
 * @property {() => void} close
 * @property {import("../html.js").Children} children
 */

/** @param {LightboxProps} props */
export function Lightbox({ title, aspect = PAIR, savable = true, close, children }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  useEffect(() => dialog.current?.showModal(), []);
  return html`<dialog
    ref=${dialog}
    class="lightbox"
    aria-label=${title}
    onClose=${close}
    onClick=${(/** @type {Event} */ event) => event.target === dialog.current && close()}
  >
    <header>
      <b class="grow">${title}</b>
      ${savable && h(Button, { icon: "export", hint: "Save this picture as PNG", kind: "bare", onClick: () => saveShown(dialog.current, title) })}
      ${h(Button, { icon: "close", hint: "Close (Esc)", onClick: close })}
    </header>
    <div class="lightbox-body" style=${{ "--aspect": aspect }}>${children}</div>
  </dialog>`;
}
