// Any stored statistic over nodes or time: pick names, read the charts, click to see the node.
import { useEffect, useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { remembered } from "../prefs.js";
import { after } from "../moment.js";
import { go, moment, openMapId, route } from "../router.js";
import { columns } from "../store.js";
import { Button, Chip } from "../parts/button.js";
import { Chart } from "../parts/chart.js";
import { StatPicker } from "../parts/stat_picker.js";
import { Empty, Failed } from "../parts/state.js";
import { useFetched } from "../parts/use.js";
import { HYPOTHESIS, TIME, point } from "../parts/strip.js";
import { csv, save, savePicture } from "../save.js";

const overTime = remembered("stats-over-time", false);
const chosen = remembered("stats-names", [TIME, HYPOTHESIS, "Memory/Working_memory_size/"].join(","));
const TOKENS = ["accent", "wm", "loop", "stm", "hand", "odom"];

/** @typedef {import("../columns.js").Columns} Columns */

export function Stats() {
  const map = /** @type {string} */ (openMapId.value);
  const data = /** @type {Columns} */ (columns.value);
  const names = (route.value.query.get("names") ?? chosen.value).split(",").filter(Boolean);
  const [at, setAt] = useState(/** @type {number | null} */ (null));
  const available = useFetched((signal) => get("/api/maps/{map}/statistic-names", { path: { map }, signal }), [map]);
  useEffect(() => data.want(names), [data, names.join()]);
  const choose = (/** @type {string[]} */ next) => {
    chosen.value = next.join(",");
    go({ view: "stats", query: { names: next.join(",") } }, { replace: true });
  };
  const all = available.data.value?.names ?? [];
  void data.revision.value;
  return html`<div class="view">
    <div class="view-head">
      <h2>Statistics</h2>
      <span class="quiet grow">${all.length ? `${text.whole(all.length)} stored` : ""}</span>
      ${h(Button, { icon: "export", label: "CSV", hint: "Save these columns, all rows", disabled: !names.length || !data.ids.length, onClick: saveAll })}
      ${h(Chip, { label: "Over time", hint: "Seconds instead of node ids", on: overTime.value, onChange: (on) => (overTime.value = on) })}
    </div>
    <div class="view-tools">${h(StatPicker, { all, names, onChoose: choose })}</div>
    <div class="view-body stats">${body()}</div>
  </div>`;

  function saveAll() {
    const table = csv([["node", data.ids], ["stamp", data.stamps], ...names.map((name) => /** @type {[string, (number | null)[]]} */ ([name, data.column(name)]))]);
    save(new Blob([table], { type: "text/csv" }), `${map}-statistics.csv`);
  }

  function body() {
    const error = available.error.value ?? data.error.value;
    if (error) return h(Failed, { error, what: "The statistics didn't arrive.", onRetry: () => (available.reload(), data.pull()) });
    if (available.data.value && !all.length) return h(Empty, { icon: "stats", title: "This map has no statistics", children: "They are stored with each node while a run makes them." });
    if (!names.length) return h(Empty, { icon: "stats", title: "Choose a statistic above", children: "Each becomes a chart; they share one cursor, and a click on a chart opens the node." });
    return names.map((name, index) =>
      h(StatChart, {
        key: name,
        data,
        name,
        token: TOKENS[index % TOKENS.length],
        at,
        onCursor: (row) => (setAt(row), point(data, row)),
        onRemove: () => choose(names.filter((one) => one !== name)),
      }),
    );
  }
}

/**
 * @typedef {object} StatChartProps
 * @property {unknown} key
 * @property {Columns} data
 * @property {string} name
 * @property {string} token
 * @property {number | null} at
 * @property {(index: number | null) => void} onCursor
 * @property {() => void} onRemove
 */

/** @param {StatChartProps} props */
function StatChart({ data, name, token, at, onCursor, onRemove }) {
  const figure = useRef(/** @type {HTMLElement | null} */ (null));
  const column = data.column(name);
  const known = column.filter((value) => value !== null);
  const start = data.stamps[0] ?? 0;
  const time = overTime.value;
  const shown = moment.value === null ? null : after(data.ids, moment.value) - 1;
  const row = at ?? shown ?? data.ids.length - 1;
  const saveChart = () => {
    const canvas = figure.current?.querySelector("canvas");
    if (canvas) savePicture(canvas, name, `${data.map}-${name}.png`);
  };
  return html`<figure class="stat-chart" ref=${figure}>
    <figcaption>
      <b class="clip" title=${name}>${name}</b>
      ${h(Button, { icon: "image", kind: "bare", hint: `Save the chart of ${name} as PNG`, onClick: saveChart })}
      ${h(Button, { icon: "close", kind: "bare", hint: `Remove ${name}`, onClick: onRemove })}
      <span class="stat-numbers quiet small">
        <output>${text.short(column[row])}</output> at ${data.ids[row] ?? text.NONE}${" · "}
        <span title="Median and maximum over the map">median ${text.short(median(known))} · max ${text.short(largest(known))}</span>
      </span>
    </figcaption>
    ${h(Chart, {
      label: `${name} over ${time ? "time" : "node ids"}`,
      lines: [{ label: name, token, kind: "area" }],
      x: time ? data.stamps.map((stamp) => stamp - start) : data.ids,
      columns: [column],
      revision: data.revision.value,
      time,
      spikes: name.startsWith("Timing"),
      shown: shown === null ? null : time ? data.stamps[shown] - start : data.ids[shown],
      onCursor,
      onPick: (index) => go({ view: "nodes", key: data.ids[index] }),
    })}
  </figure>`;
}

/** @param {number[]} values */
function median(values) {
  if (!values.length) return null;
  const sorted = values.toSorted((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)];
}

/** @param {number[]} values */
function largest(values) {
  return values.length ? values.reduce((most, value) => Math.max(most, value)) : null;
}
