// Finds statistics by name and adds them to the charts.
import { useState } from "preact/hooks";
import { html } from "../html.js";

const MOST = 60;

/** @param {{all: string[], names: string[], onChoose: (names: string[]) => void}} props */
export function StatPicker({ all, names, onChoose }) {
  const [query, setQuery] = useState("");
  const [open, setOpen] = useState(false);
  const found = all.filter((name) => name.toLowerCase().includes(query.toLowerCase())).slice(0, MOST);
  const toggle = (/** @type {string} */ name) =>
    onChoose(names.includes(name) ? names.filter((one) => one !== name) : [name, ...names]);
  return html`<div
    class="picker"
    onFocusOut=${(/** @type {FocusEvent} */ { currentTarget, relatedTarget }) =>
      !(/** @type {Node} */ (currentTarget).contains(/** @type {Node | null} */ (relatedTarget))) && setOpen(false)}
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => {
      if (event.key !== "Escape") return;
      // Else the field would clear itself, which opens the list again.
      event.preventDefault();
      setOpen(false);
    }}
  >
    <input
      type="search"
      class="field wide"
      placeholder="Add a statistic: Timing, Loop, Memory, Odometry…"
      aria-label="Find a statistic"
      aria-expanded=${open}
      aria-controls="stat-list"
      role="combobox"
      value=${query}
      onFocus=${() => setOpen(true)}
      onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => (setQuery(currentTarget.value), setOpen(true))}
    />
    ${open &&
    html`<ul id="stat-list" class="picker-list" role="group" aria-label="Statistics">
      ${found.map(
        (name) => html`<li key=${name}>
          <label><input type="checkbox" checked=${names.includes(name)} onChange=${() => toggle(name)} />${name}</label>
        </li>`,
      )}
      ${!found.length && html`<li class="quiet">No statistic is called that.</li>`}
    </ul>`}
  </div>`;
}
