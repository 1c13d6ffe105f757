// All that happened in the course of the map, by kind; a row leads to its moment.
import { useEffect, useRef } from "preact/hooks";
import { h, html } from "../html.js";
import * as text from "../format.js";
import { KINDS, events, goTo, kind, pause, timeline } from "../moment.js";
import { moment } from "../router.js";
import { Button, Chip } from "./button.js";
import { Empty } from "./state.js";
import { Table } from "./table.js";

/** @typedef {import("../moment.js").TimelineEvent} TimelineEvent */

/** @type {import("./table.js").TableColumn<TimelineEvent>[]} */
const COLUMNS = [
  { key: "at", label: "Node", width: "56px", cell: ({ at }) => at },
  { key: "kind", label: "Event", width: "118px", cell: ({ kind: name }) => kindCell(name) },
  { key: "text", label: "What happened", width: "minmax(0, 1fr)", cell: (event) => html`<span title=${event.text}>${event.text}</span>` },
];

/** @param {TimelineEvent["kind"]} name */
function kindCell(name) {
  const [, label, token] = /** @type {[string, string, string]} */ (KINDS.find(([one]) => one === name));
  return html`<span class=${`ink-${token}`} aria-hidden="true">● </span>${label}`;
}

/** @param {{close: () => void}} props */
export function EventList({ close }) {
  const box = useRef(/** @type {HTMLElement | null} */ (null));
  const found = events.value;
  const selected = moment.value === null ? -1 : found.findLastIndex(({ at }) => at <= /** @type {number} */ (moment.value));
  useEffect(() => /** @type {HTMLElement | null} */ (box.current?.querySelector("[tabindex]"))?.focus(), []);
  return html`<section
    ref=${box}
    class="events"
    aria-label="What happened"
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => event.key === "Escape" && close()}
  >
    <header>
      <div class="chips" role="toolbar" aria-label="Kinds of events">
        ${KINDS.map(([name, label]) => h(KindChip, { key: name, name, label }))}
      </div>
      ${h(Button, { icon: "close", kind: "bare", hint: "Close (Esc)", onClick: close })}
    </header>
    ${
      found.length
        ? h(/** @type {typeof Table<TimelineEvent>} */ (Table), {
            label: "Events",
            columns: COLUMNS,
            total: found.length,
            rowAt: (row) => found[row],
            selected,
            onSelect: (row) => (pause(), goTo(found[row].at)),
            order: "",
            onOrder: () => {},
          })
        : h(Empty, { icon: "list", title: "Nothing of this kind happened", children: "Choose another kind above, or none for all." })
    }
  </section>`;
}

/** @param {{name: TimelineEvent["kind"], label: string, key?: unknown}} props */
function KindChip({ name, label }) {
  const count = (timeline.value?.events ?? []).filter((one) => one.kind === name).length;
  return h(Chip, {
    label: `${label} ${text.whole(count)}`,
    on: kind.value === name,
    disabled: count === 0 && kind.value !== name,
    hint: count ? "Show and jump to these alone" : "None in this map",
    onChange: (on) => (kind.value = on ? name : ""),
  });
}
