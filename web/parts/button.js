// A button, and a toggle that says whether it is pressed.
import { cx, h, html } from "../html.js";
import { Icon } from "./icons.js";

/**
 * @typedef {object} ButtonProps
 * @property {string} [label]
 * @property {string} [hint] text of the tooltip, and of screen readers when there is no label
 * @property {import("./icons.js").IconName} [icon]
 * @property {string} [keys] the key that does the same
 * @property {"plain" | "good" | "bad" | "accent" | "bare"} [kind]
 * @property {boolean} [disabled]
 * @property {boolean} [pressed] makes it a toggle
 * @property {string} [id] for tests and labels
 * @property {() => void} onClick
 */

/** @param {ButtonProps} props */
export function Button({ label, hint, icon, keys, kind = "plain", disabled = false, pressed, id, onClick }) {
  return html`<button
    type="button"
    id=${id}
    class=${cx("button", `button-${kind}`, !label && "button-icon")}
    title=${hint}
    aria-label=${label ? undefined : hint}
    aria-pressed=${pressed}
    aria-keyshortcuts=${keys}
    disabled=${disabled}
    onClick=${onClick}
  >
    ${icon && h(Icon, { name: icon })}${label && html`<span>${label}</span>`}${keys && html`<kbd>${keys}</kbd>`}
  </button>`;
}

/** @param {{label: string, on: boolean, hint?: string, disabled?: boolean, onChange: (on: boolean) => void}} props */
export function Chip({ label, on, hint, disabled = false, onChange }) {
  return html`<button
    type="button"
    class="chip"
    title=${hint}
    aria-pressed=${on}
    disabled=${disabled}
    onClick=${() => onChange(!on)}
  >
    ${label}
  </button>`;
}
