// Ctrl+K: one field that finds maps, views, nodes, loops, parameters and commands.
import { signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { findCommands } from "../commands.js";

/** @type {import("@preact/signals").Signal<string | null>} what the field starts with; null while it is closed */
const opened = signal(null);

/** @param {string} [start] */
export function openPalette(start = "") {
  opened.value = start;
}

export function Palette() {
  return opened.value === null ? null : h(Dialog, { start: opened.value, close: () => (opened.value = null) });
}

/** @param {{start: string, close: () => void}} props */
function Dialog({ start, close }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  const [query, setQuery] = useState(start);
  const [chosen, setChosen] = useState(0);
  const found = findCommands(query);
  const run = (/** @type {number} */ index) => {
    close();
    found[index]?.run();
  };
  useEffect(() => dialog.current?.showModal(), []);
  return html`<dialog
    ref=${dialog}
    class="palette"
    aria-label="Search or command"
    onClose=${close}
    onClick=${(/** @type {Event} */ event) => event.target === dialog.current && close()}
  >
    <input
      class="palette-input"
      type="text"
      role="combobox"
      aria-expanded="true"
      aria-controls="palette-list"
      aria-activedescendant=${`palette-${chosen}`}
      aria-label="Search or command"
      placeholder="A node number, a loop as 147-61, a parameter, a map, a command"
      value=${query}
      onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => {
        setQuery(currentTarget.value);
        setChosen(0);
      }}
      onKeyDown=${(/** @type {KeyboardEvent} */ event) => steer(event, found.length, chosen, setChosen, run)}
    />
    <ul id="palette-list" role="listbox" class="palette-list" aria-label="Found">
      ${found.map(
        (one, index) =>
          html`<li
            key=${one.label}
            id=${`palette-${index}`}
            role="option"
            aria-selected=${index === chosen}
            onPointerMove=${() => setChosen(index)}
            onClick=${() => run(index)}
          >
            <span class="quiet small palette-kind">${one.kind}</span><span class="grow clip">${one.label}</span>
            <span class="quiet small clip">${one.detail}</span>
          </li>`,
      )}
      ${!found.length && html`<li class="quiet">Nothing is called that. Try a node number or part of a parameter's name.</li>`}
    </ul>
  </dialog>`;
}

/**
 * @param {KeyboardEvent} event
 * @param {number} count
 * @param {number} chosen
 * @param {(index: number) => void} setChosen
 * @param {(index: number) => void} run
 */
function steer(event, count, chosen, setChosen, run) {
  if (event.key === "Enter") run(chosen);
  else if (event.key === "ArrowDown") setChosen(Math.min(count - 1, chosen + 1));
  else if (event.key === "ArrowUp") setChosen(Math.max(0, chosen - 1));
  else return;
  event.preventDefault();
}
