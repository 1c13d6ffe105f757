// The review queue: every loop that was looked at, the evidence of one, and the decisions of people.
import { useEffect, useMemo, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { decide } from "../actions.js";
import { on } from "../events.js";
import * as text from "../format.js";
import { useKeys } from "../keys.js";
import { LoopList, NO_FILTER } from "../loop_list.js";
import { filterOf, queryOf } from "../loop_query.js";
import { go, link, moment, openMapId, route } from "../router.js";
import { remembered } from "../prefs.js";
import { graphRevision, inForce } from "../store.js";
import { BulkBar } from "../parts/bulk.js";
import { EffectLine, lockReason } from "../parts/decision_bar.js";
import { Journal } from "../parts/journal.js";
import { Jobs } from "../parts/jobs.js";
import { LinkEvidence } from "../parts/link.js";
import { LinkTool } from "../parts/link_tool.js";
import { LoopFilter } from "../parts/loop_filter.js";
import { loopColumns } from "../parts/loop_columns.js";
import { Empty, Failed, Loading } from "../parts/state.js";
import { Table } from "../parts/table.js";
import { useChanged } from "../parts/use.js";
import { WhatIfPanel } from "../parts/what_if.js";

/** @typedef {import("../loop_list.js").LoopRow} LoopRow */

const order = remembered("loop-order", "-doubt");
/** @type {[string, string][]} */
const TABS = [
  ["", "Queue"],
  ["what-if", "What if"],
  ["link", "Link"],
  ["jobs", "Bulk"],
  ["journal", "Journal"],
];

export function Loops() {
  const map = /** @type {string} */ (openMapId.value);
  const list = useMemo(() => new LoopList(map), [map]);
  const { key, query } = route.value;
  const [filter, setFilter] = useState(() => filterOf(query) ?? NO_FILTER);
  const tab = TABS.find(([name]) => name === query.get("tab"))?.[0] ?? "";
  // Links within the page that name no filter leave the one that is there.
  useEffect(() => setFilter((last) => filterOf(query) ?? last), [String(query)]);
  const change = (/** @type {typeof NO_FILTER} */ next) => {
    setFilter(next);
    go({ view: "loops", key, query: queryOf(next) }, { replace: true });
  };

  useEffect(() => void list.pull(), [list]);
  useEffect(() => on("decision", (_, of) => of === map && void list.pull({ all: true })), [list]);
  useChanged(graphRevision, () => void list.pull());

  void list.revision.value;
  const rows = list.rows({ ...filter, order: order.value });
  const selected = rows.findIndex((row) => row.key === key || `${row.to}-${row.from}` === key);
  const select = (/** @type {number} */ index) => rows[index] && go({ view: "loops", key: rows[index].key, query: tab ? { tab } : queryOf(filter) });
  const step = (/** @type {number} */ by) => select(selected < 0 ? 0 : Math.max(0, Math.min(rows.length - 1, selected + by)));
  const reload = () => list.pull({ all: true });
  const answer = async (/** @type {"undo" | "redo"} */ action) => void (!lockReason() && (await decide({ action })) && reload());
  // A link that the queue does not list is walked along the path, by its evidence.
  const walked = Boolean(key) && selected < 0;
  useKeys({ ...(walked ? {} : { j: () => step(1), k: () => step(-1) }), u: () => void answer("undo"), U: () => void answer("redo") });

  return html`<div class="view view-loops">
    <div class="view-head">
      <h2>Loop closures</h2>
      <span class="quiet grow">${list.byKey.size ? text.whole(list.byKey.size) : ""}</span>
      <nav class="tabs" aria-label="Loops">
        ${TABS.map(([name, label]) => html`<a key=${name} href=${tabLink(name, key)} aria-current=${name === tab ? "true" : undefined}>${label}</a>`)}
      </nav>
    </div>
    ${part()}
    ${key && h(LinkEvidence, { key, map, link: key, row: rows[selected], onStep: step, onDecided: reload })}
  </div>`;

  function part() {
    if (tab === "link") return h(LinkTool, { map, onDone: reload });
    if (tab === "jobs") return h(Jobs, { map });
    if (tab === "what-if") return h(WhatIfPanel, { map, selected: key });
    return tab === "journal" ? h(Journal, { map, quiet: Boolean(key) }) : queue();
  }

  function queue() {
    return html`<div class="view-part">
      ${moment.value !== null && html`<p class="note small">The 3D view shows the map after node ${moment.value}; this list is that of now, with what people decided.</p>`}
      ${list.byKey.size > 0 && h(LoopFilter, { filter, counts: list.counts(), sessions: list.sessions(), order: order.value, onChange: change, onOrder: (next) => (order.value = next) })}
      <div class="view-table">${queueTable()}</div>
      ${list.byKey.size > 0 && h(BulkBar, { rows, total: list.byKey.size, onDecided: () => void reload() })}
      ${!key && h(EffectLine, {})}
    </div>`;
  }

  function queueTable() {
    if (list.error && !list.byKey.size) return h(Failed, { error: list.error, what: "The loops didn't arrive.", onRetry: () => void reload() });
    if (!list.loaded) return h(Loading, {});
    if (!list.byKey.size) return h(NoLoops, {});
    if (!rows.length) {
      const clear = html`<button type="button" class="button button-plain" onClick=${() => change(NO_FILTER)}>Clear the filter</button>`;
      return h(Empty, { icon: "search", title: "No loop passes the filter", children: clear });
    }
    return h(/** @type {typeof Table<LoopRow>} */ (Table), {
      label: "Loop closures",
      columns: loopColumns(order.value),
      total: rows.length,
      rowAt: (index) => rows[index],
      selected,
      onSelect: select,
      order: order.value,
      onOrder: (next) => (order.value = next),
    });
  }
}

/** @param {string} tab @param {string | null} key */
function tabLink(tab, key) {
  if (tab === "link") return link({ view: "loops", query: ends(key) });
  return link({ view: "loops", key: tab === "jobs" ? null : key, query: tab ? { tab } : {} });
}

/** The link tool opens with the link that is shown. @param {string | null} key @returns {Record<string, string>} */
function ends(key) {
  const [from, to] = (key ?? "").split("-");
  return from && to ? { tab: "link", from, to } : { tab: "link" };
}

function NoLoops() {
  const threshold = text.short(Number(inForce("Rtabmap/LoopThr") ?? NaN));
  return h(Empty, {
    icon: "loops",
    title: "No loop was looked at yet",
    children: html`A loop is tried when the hypothesis reaches <b>Rtabmap/LoopThr</b> (${threshold} now) or when the path comes near itself.${" "}
      <a href=${link({ view: "params", query: { q: "LoopThr" } })}>Change LoopThr</a>`,
  });
}
