// Labelled fields of forms.
import { html } from "../html.js";

/** @typedef {{currentTarget: HTMLInputElement}} InputEvent */
/** @typedef {{currentTarget: HTMLSelectElement}} SelectEvent */

/** @param {{label: string, value: string, step?: string, hint?: string, onChange: (value: string) => void, key?: unknown}} props */
export function NumberField({ label, value, step = "any", hint, onChange }) {
  return html`<label class="form-field small" title=${hint}>
    <span class="quiet">${label}</span>
    <input class="field number" type="number" step=${step} value=${value} onInput=${(/** @type {InputEvent} */ event) => onChange(event.currentTarget.value)} />
  </label>`;
}

/** @param {{label: string, value: string, options: [string, string][], hint?: string, onChange: (value: string) => void}} props value and text of each option */
export function SelectField({ label, value, options, hint, onChange }) {
  return html`<label class="form-field small" title=${hint}>
    <span class="quiet">${label}</span>
    <select class="chip" value=${value} onChange=${(/** @type {SelectEvent} */ event) => onChange(event.currentTarget.value)}>
      ${options.map(([key, name]) => html`<option key=${key} value=${key}>${name}</option>`)}
    </select>
  </label>`;
}

/** @param {{label: string, on: boolean, hint?: string, onChange: (on: boolean) => void}} props */
export function CheckField({ label, on, hint, onChange }) {
  return html`<label class="form-check small" title=${hint}>
    <input type="checkbox" checked=${on} onChange=${(/** @type {InputEvent} */ event) => onChange(event.currentTarget.checked)} />${" "}${label}
  </label>`;
}

/** @type {[string, string][]} how two nodes are registered */
export const METHODS = [["visual", "Images"], ["icp", "Clouds (ICP)"], ["both", "Images, then clouds"]];
/** @type {[string, string][]} where a registration begins */
export const GUESSES = [["graph", "the optimised poses"], ["none", "no guess"]];
