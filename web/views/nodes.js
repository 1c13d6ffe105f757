// All nodes of the map in a table that fetches what is in sight, and the inspector of one.
import { useEffect, useMemo, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { ApiError } from "../api.js";
import * as text from "../format.js";
import { useKeys } from "../keys.js";
import { pickNode, second } from "../pair.js";
import { go, openMapId, route } from "../router.js";
import { columns, graphRevision, info } from "../store.js";
import { Chip } from "../parts/button.js";
import { Badge } from "../parts/facts.js";
import { ChoiceBar, useChoice } from "../parts/node_choice.js";
import { NodeInspector } from "../parts/node.js";
import { NodePairInspector } from "../parts/node_pair.js";
import { NodeSearch, SearchHelp } from "../parts/node_search.js";
import { Empty, Failed } from "../parts/state.js";
import { Table } from "../parts/table.js";
import { useChanged } from "../parts/use.js";
import { Window } from "../window.js";

/** @typedef {import("../store.js").Schemas["NodeRow"]} NodeRow */
/** @typedef {import("../parts/table.js").TableColumn<NodeRow>} NodeColumn */

/** @typedef {{order?: string, q?: string, dropped?: boolean}} Asked */

const ORDERS = ["id", "-id", "stamp", "-stamp", "weight", "-weight"];
const TIERS = { stm: "STM", wm: "WM", ltm: "LTM" };

/** @type {NodeColumn[]} */
const COLUMNS = [
  { key: "id", label: "Node", width: "54px", sortable: true, cell: ({ id }) => id },
  {
    key: "tier",
    label: "Memory",
    width: "70px",
    cell: ({ tier }) => tier && html`<span class=${`ink-${tier}`}>● </span>${TIERS[/** @type {"stm"} */ (tier)]}`,
  },
  { key: "stamp", label: "Time", width: "74px", sortable: true, number: true, cell: ({ stamp }) => text.clock(stamp) },
  { key: "weight", label: "Weight", width: "64px", sortable: true, number: true, hint: "How often it was seen again", cell: ({ weight }) => text.whole(weight) },
  { key: "words", label: "Words", width: "58px", number: true, cell: ({ words }) => text.whole(words) },
  { key: "loops", label: "Loops", width: "minmax(52px, 1fr)", number: true, cell: ({ loops }) => (loops ? h(Badge, { tone: "hand", children: loops }) : "") },
];

export function Nodes() {
  const map = /** @type {string} */ (openMapId.value);
  const asked = route.value.query;
  const order = /** @type {import("../window.js").NodeOrder} */ (ORDERS.find((name) => name === asked.get("order")) ?? "id");
  const query = asked.get("q") ?? "";
  const dropped = asked.has("dropped");
  const look = (/** @type {Asked} */ next) => {
    const { order: by, q, dropped: all } = { order, q: query, dropped, ...next };
    const b = asked.get("b");
    const changed = { ...(by !== "id" && { order: by }), ...(q && { q }), ...(all && { dropped: "yes" }), ...(b && { b }) };
    go({ view: "nodes", key: route.value.key, query: changed }, { replace: true });
  };
  const rows = useMemo(() => new Window(map), [map]);
  const selected = Number(route.value.key ?? 0);
  // A row that was chosen before it arrived: it is selected as soon as it is here.
  const [wanted, setWanted] = useState(-1);

  useEffect(() => rows.seek(selected), [rows, selected]);
  useEffect(() => rows.ask(order, query, dropped), [rows, order, query, dropped]);
  useEffect(() => void (columns.value && rows.refresh()), [graphRevision.value]);
  useChanged(/** @type {import("../columns.js").Columns} */ (columns.value).revision, () => rows.refresh());

  void rows.revision.value;
  const choice = useChoice(rows);
  const select = (/** @type {number} */ row, /** @type {MouseEvent | undefined} */ event = undefined) => {
    if (choice.click(row, event, at)) return;
    const found = rows.at(row);
    if (found) pickNode(found.id);
    setWanted(found ? -1 : row);
  };
  useEffect(() => void (wanted >= 0 && rows.at(wanted) && select(wanted)));
  const at = wanted >= 0 ? wanted : rows.indexOf(selected);
  const step = (/** @type {number} */ by) => select(Math.max(0, Math.min(rows.total - 1, at + by)));
  // Two beside each other have these keys of their own.
  useKeys(second() === null ? { j: () => step(1), k: () => step(-1) } : {});

  return html`<div class="view">
    <div class="view-head">
      <h2>Nodes</h2>
      <span class="quiet grow">${rows.loaded ? text.whole(rows.total) : ""}</span>
      ${(info.value?.dropped ?? 0) > 0 &&
      h(Chip, {
        label: "Dropped",
        on: dropped,
        hint: `${text.whole(info.value?.dropped)} nodes that were merged or dropped: kept in the file, no part of the map`,
        onChange: (on) => look({ dropped: on }),
      })}
      ${h(NodeSearch, { query, onChange: (q) => look({ q }) })}
    </div>
    <div class="view-table">${nodeTable()}</div>
    ${rows.loaded && h(ChoiceBar, { choice, rows, onDone: () => rows.refresh() })}
    ${selected > 0 && inspector()}
  </div>`;

  function inspector() {
    const b = second();
    return b === null ? h(NodeInspector, { map, id: selected, shown: { order, q: query, dropped } }) : h(NodePairInspector, { map, a: selected, b, shown: { order, q: query, dropped } });
  }

  function nodeTable() {
    if (rows.error instanceof ApiError && rows.error.code === "query") return h(Empty, { icon: "search", title: "This is not understood", children: html`${rows.error.message}.` });
    if (rows.error) return h(Failed, { error: rows.error, what: "The nodes didn't arrive.", onRetry: () => rows.refresh() });
    if (rows.loaded && !rows.total) {
      return query
        ? h(Empty, { icon: "search", title: "No node fits", children: h(SearchHelp, {}) })
        : h(Empty, { icon: "nodes", title: "This map has no nodes yet", children: "They appear here as soon as the run adds them." });
    }
    return h(/** @type {typeof Table<NodeRow>} */ (Table), {
      label: "Nodes",
      columns: COLUMNS,
      total: rows.total,
      rowAt: (row) => rows.at(row),
      onRange: (first, last) => rows.show(first, last),
      selected: at,
      onSelect: select,
      chosen: (row) => choice.ids.has(rows.at(row)?.id ?? 0),
      order,
      onOrder: (next) => look({ order: next }),
    });
  }
}
