// Looking for nodes: one field, and what it understands.
import { html } from "../html.js";

/** @type {[string, string][]} example, what it finds */
const EXAMPLES = [
  ["12", "ids and labels that hold it"],
  ["id:100..200", "a range of ids"],
  ["label:door", "a label; label: for all that have one"],
  ["time:10:15", "a minute of the day, UTC; time:10:15..10:20:30"],
  ["time:2026-11-22", "a day; time:2026-11-22T10:15 a minute of it"],
  ["stamp:>1305031105", "stamps in seconds"],
  ["near 1.2 3.4 2", "within 2 m of a place of the map; 1 m without"],
  ["near #57", "around node 57"],
  ["loops:>0 session:1", "all parts must hold; also weight: and memory:wm"],
];

/** @param {{query: string, onChange: (query: string) => void}} props */
export function NodeSearch({ query, onChange }) {
  return html`<span class="node-search">
    <input
      type="search"
      class="field"
      placeholder="Id, label, time:, near x y"
      aria-label="Find nodes by id, label, time or place"
      title=${EXAMPLES.map(([example, meaning]) => `${example} — ${meaning}`).join("\n")}
      value=${query}
      onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => onChange(currentTarget.value)}
    />
  </span>`;
}

export function SearchHelp() {
  return html`<dl class="search-help">
    ${EXAMPLES.map(([example, meaning]) => html`<div key=${example}><dt><code>${example}</code></dt><dd>${meaning}</dd></div>`)}
  </dl>`;
}
