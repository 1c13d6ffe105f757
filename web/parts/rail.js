// The left rail: one link for each view.
import { h, html } from "../html.js";
import { link, openMapId, route } from "../router.js";
import { Icon } from "./icons.js";

/** @type {{view: import("../router.js").View, label: string, keys: string}[]} */
export const ENTRIES = [
  { view: "maps", label: "Maps", keys: "1" },
  { view: "nodes", label: "Nodes", keys: "2" },
  { view: "loops", label: "Loops", keys: "3" },
  { view: "params", label: "Params", keys: "4" },
  { view: "stats", label: "Stats", keys: "5" },
  { view: "graph", label: "Graph", keys: "6" },
];

export function Rail() {
  const { view } = route.value;
  return html`<nav class="rail" aria-label="Views">
    ${ENTRIES.map((entry) => {
      const usable = openMapId.value !== null || entry.view === "maps";
      return html`<a
        key=${entry.view}
        class="rail-item"
        href=${usable ? link({ view: entry.view }) : undefined}
        aria-current=${entry.view === view ? "page" : undefined}
        aria-disabled=${usable ? undefined : "true"}
        aria-keyshortcuts=${entry.keys}
        title=${usable ? `${entry.label} (${entry.keys})` : "Open a map first"}
      >
        ${h(Icon, { name: entry.view })}<span>${entry.label}</span>
      </a>`;
    })}
  </nav>`;
}
