// Names and values in two or four columns, and the small coloured words beside them.
import { cx, html } from "../html.js";

/** @typedef {[string, import("../html.js").Children, string?]} Fact name, value, and a hint */

/** @param {{facts: Fact[], columns?: 1 | 2}} props */
export function Facts({ facts, columns = 2 }) {
  return html`<dl class=${cx("facts", `facts-${columns}`)}>
    ${facts.map(([name, value, hint]) => html`<div key=${name} title=${hint}><dt>${name}</dt><dd>${value}</dd></div>`)}
  </dl>`;
}

/** @typedef {"good" | "bad" | "warn" | "hand" | "quiet" | "accent"} Tone */

/** @param {{tone: Tone, children: import("../html.js").Children, hint?: string}} props */
export function Badge({ tone, children, hint }) {
  return html`<span class=${`badge badge-${tone}`} title=${hint}>${children}</span>`;
}
