// Labelled fields of forms.
import { h, html } from "../html.js";

/** @typedef {{currentTarget: HTMLInputElement}} InputEvent */
/** @typedef {{currentTarget: HTMLSelectElement}} SelectEvent */

/** @param {{label: string, value: string, step?: string, hint?: string, placeholder?: string, onChange: (value: string) => void, key?: unknown}} props */
export function NumberField({ label, value, step = "any", hint, placeholder, onChange }) {
  return html`<label class="form-field small" title=${hint}>
    <span class="quiet">${label}</span>
    <input class="field number" type="number" step=${step} placeholder=${placeholder} value=${value} onInput=${(/** @type {InputEvent} */ event) => onChange(event.currentTarget.value)} />
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

/** @param {{wanted: {intra: boolean, inter: boolean, session: string}, onChange: (change: {intra?: boolean, inter?: boolean, session?: string}) => void}} props */
export function Sessions({ wanted, onChange }) {
  return html`<span class="form-row">
    ${h(CheckField, { label: "within a session", on: wanted.intra, onChange: (intra) => onChange({ intra }) })}
    ${h(CheckField, { label: "between sessions", on: wanted.inter, onChange: (inter) => onChange({ inter }) })}
    ${h(NumberField, { label: "only session", value: wanted.session, step: "1", hint: "Only with a node of this session; empty for all", onChange: (session) => onChange({ session }) })}
  </span>`;
}

/** Fields hold text. @template {Record<string, string | boolean>} T @param {T} fields */
export function numbers(fields) {
  const worth = (/** @type {string | boolean} */ value) => (typeof value === "string" && value.trim() && Number.isFinite(Number(value)) ? Number(value) : value);
  // A field that is empty leaves it at what the engine takes.
  return Object.fromEntries(Object.entries(fields).filter(([, value]) => value !== "").map(([name, value]) => [name, worth(value)]));
}

/** A number of metres; empty is 0. @param {string} label @param {string} empty @param {number} value @param {(value: number) => void} change */
export function metres(label, empty, value, change) {
  return html`<input
    class="field number"
    type="number"
    min="0"
    max="1000"
    step="0.1"
    aria-label=${label}
    title=${label}
    placeholder=${empty}
    value=${value || ""}
    onChange=${(/** @type {InputEvent} */ { currentTarget }) => change(Math.max(0, Math.min(1000, Number(currentTarget.value) || 0)))}
  />`;
}
