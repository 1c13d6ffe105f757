// The bottom strip: update time, memory sizes and the loop hypothesis while a map grows.
import { useEffect, useState } from "preact/hooks";
import { h, html } from "../html.js";
import * as text from "../format.js";
import { draft, tryOut } from "../draft.js";
import { link, moment } from "../router.js";
import { after, goTo, pause } from "../moment.js";
import { hovered } from "../picking.js";
import { columns, inForce } from "../store.js";
import { Chart } from "./chart.js";
import { LTM, STM, WM } from "./legend.js";

export const TIME = "Timing/Total/ms";
export const HYPOTHESIS = "Loop/Highest_hypothesis_value/";
const BEST = "Loop/Highest_hypothesis_id/";
const ACCEPTED = "Loop/Accepted_hypothesis_id/";
const NEAR = "Proximity/Space_last_detection_id/";
const NAMES = [TIME, STM, WM, LTM, HYPOTHESIS, BEST, ACCEPTED, NEAR];

/** @typedef {import("../columns.js").Columns} Columns */

export function Strip() {
  const data = columns.value;
  const [under, setUnder] = useState(/** @type {number | null} */ (null));
  useEffect(() => data?.want(NAMES), [data]);
  if (!data) return null;
  void data.revision.value;
  const at = under ?? (moment.value === null ? null : after(data.ids, moment.value) - 1);
  const props = { data, at, marks: closures(data), onCursor: (/** @type {number | null} */ row) => (setUnder(row), point(data, row)) };
  return html`<section class="strip" aria-label="Live charts">
    ${h(TimeChart, props)}${h(MemoryChart, props)}${h(HypothesisChart, props)}
  </section>`;
}

/** Mark the node of a row in 3D. @param {Columns} data @param {number | null} row */
export function point(data, row) {
  hovered.value = row === null ? null : (data.ids[row] ?? null);
}

/**
 * @typedef {object} StripProps
 * @property {Columns} data
 * @property {number | null} at row under the cursor, else of the moment that is shown
 * @property {import("./chart.js").Mark[]} marks
 * @property {(index: number | null) => void} onCursor
 */

/** The nodes at which a loop was closed. @param {Columns} data @returns {import("./chart.js").Mark[]} */
function closures(data) {
  const [accepted, near, hypothesis] = [ACCEPTED, NEAR, HYPOTHESIS].map((name) => data.column(name));
  return data.ids.flatMap((id, row) => {
    if (accepted[row]) return [{ at: id, height: hypothesis[row] ?? 0 }];
    return near[row] ? [{ at: id, height: 0 }] : [];
  });
}

/** @param {StripProps} props */
function TimeChart({ data, at, marks, onCursor }) {
  const threshold = Number(inForce("Rtabmap/TimeThr") ?? 0);
  const notes = [html`<span class="ink-warn">TimeThr ${threshold > 0 ? `${text.short(threshold)} ms` : "off"}</span>`];
  return h(StripChart, {
    data,
    title: "Update time",
    value: `${text.fixed(valueAt(data, TIME, at), 0)} ms`,
    notes,
    lines: [{ label: "ms", token: "accent", kind: "area" }],
    names: [TIME],
    spikes: true,
    thresholds: threshold > 0 ? [{ value: threshold, token: "warn" }] : [],
    marks,
    onCursor,
  });
}

/** @param {StripProps} props */
function MemoryChart({ data, at, marks, onCursor }) {
  const sizes = /** @type {[string, string, string][]} */ ([
    ["STM", STM, "stm"],
    ["WM", WM, "wm"],
    ["LTM", LTM, "ltm"],
  ]);
  return h(StripChart, {
    data,
    title: "Memory",
    value: "",
    notes: sizes.map(
      ([label, name, token]) =>
        html`<span key=${label}><i class=${`mark mark-dot ink-${token}`} aria-hidden="true"></i> ${label} ${text.whole(valueAt(data, name, at))}</span>`,
    ),
    lines: sizes.map(([label, , token]) => ({ label, token })),
    names: sizes.map(([, name]) => name),
    marks,
    onCursor,
  });
}

/** @param {StripProps} props */
function HypothesisChart({ data, at, marks, onCursor }) {
  const threshold = Number(inForce("Rtabmap/LoopThr") ?? 0);
  const best = valueAt(data, BEST, at);
  return h(StripChart, {
    data,
    title: "Hypothesis",
    value: text.fixed(valueAt(data, HYPOTHESIS, at), 2),
    notes: [
      html`<a class="ink-warn" href=${link({ view: "loops", query: { tab: "what-if" } })} title="What another threshold would mean">LoopThr ${text.short(threshold)}</a>`,
      best ? html`<span title="The most probable place">→ ${text.whole(best)}</span>` : "",
      html`<span class="ink-loop" title="Nodes at which a loop was closed">▾ ${text.whole(marks.length)}</span>`,
    ],
    lines: [{ label: "hypothesis", token: "accent", kind: "area" }],
    names: [HYPOTHESIS],
    thresholds: [{ value: threshold, token: "warn" }, ...(draft.value === null || draft.value === threshold ? [] : [{ value: draft.value, token: "accent" }])],
    dragged: draft.value,
    onDrag: tryOut,
    marks,
    stems: true,
    onCursor,
  });
}

/**
 * @typedef {object} StripChartProps
 * @property {Columns} data
 * @property {string} title
 * @property {string} value
 * @property {import("../html.js").Children} notes
 * @property {import("./chart.js").Line[]} lines
 * @property {string[]} names
 * @property {import("./chart.js").Threshold[]} [thresholds]
 * @property {import("./chart.js").Mark[]} marks
 * @property {boolean} [stems]
 * @property {boolean} [spikes]
 * @property {number | null} [dragged] a threshold that can be dragged
 * @property {(value: number) => void} [onDrag]
 * @property {(index: number | null) => void} onCursor
 */

/** @param {StripChartProps} props */
function StripChart({ data, title, value, notes, lines, names, thresholds, marks, stems, spikes, dragged, onDrag, onCursor }) {
  return html`<figure class="strip-chart">
    <figcaption><b>${title}</b> <output>${value}</output> ${notes}</figcaption>
    ${h(Chart, {
      label: `${title} over node ids`,
      lines,
      x: data.ids,
      columns: names.map((name) => data.column(name)),
      revision: data.revision.value,
      thresholds,
      marks,
      stems,
      spikes,
      dragged,
      onDrag,
      onCursor,
      shown: moment.value,
      onPick: (index) => (pause(), goTo(data.ids[index])),
    })}
  </figure>`;
}

/** @param {Columns} data @param {string} name @param {number | null} at */
function valueAt(data, name, at) {
  return at === null ? data.last(name) : (data.column(name)[at] ?? null);
}
