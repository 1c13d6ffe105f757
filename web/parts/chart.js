// One uPlot chart over node ids, with threshold lines and marks; all charts share one cursor.
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { html } from "../html.js";
import { color, theme } from "../theme.js";
import { listenForDrag } from "./chart_drag.js";
import { drawCutOff, drawGuides } from "./chart_guides.js";
import { ceilingOf, yRange } from "./chart_range.js";

/** @typedef {(number | null)[]} Column */
/**
 * @typedef {object} Line
 * @property {string} label
 * @property {string} token colour of tokens.css
 * @property {"line" | "area" | "bars"} [kind]
 * @property {(value: number | null) => string} [text]
 */
/** @typedef {import("./chart_guides.js").Threshold} Threshold */
/** @typedef {import("./chart_guides.js").Mark} Mark */
/**
 * @typedef {object} ChartProps
 * @property {string} label for screen readers
 * @property {Line[]} lines
 * @property {Column} x
 * @property {Column[]} columns one for each line
 * @property {number} revision grows when the columns changed in place
 * @property {Threshold[]} [thresholds]
 * @property {Mark[]} [marks] small triangles at the top
 * @property {boolean} [stems] a stem as high as its value under each mark
 * @property {number | null} [shown] x of the moment that is shown
 * @property {boolean} [time] x is seconds, not ids
 * @property {boolean} [fromZero]
 * @property {boolean} [spikes] a few values far above all others are cut off, and said
 * @property {(index: number) => void} [onPick] a click on a row
 * @property {number | null} [dragged] height of a line that can be dragged, null while there is none
 * @property {(value: number) => void} [onDrag]
 * @property {(index: number | null) => void} [onCursor]
 */

/** Half of the width of a label of seconds. */
const HALF_LABEL_PX = 12;
const CURSOR = "slamdeck";
const CURSOR_TIME = "slamdeck time";

/** @param {ChartProps} props */
export function Chart(props) {
  const box = useRef(/** @type {HTMLDivElement | null} */ (null));
  const plot = useRef(/** @type {uPlot | null} */ (null));
  const latest = useRef(props);
  const [zoomed, setZoomed] = useState(false);
  latest.current = props;
  const shape = `${theme.value} ${props.time} ${props.lines.map((line) => line.label + line.kind).join()}`;

  useEffect(() => {
    if (!box.current) return undefined;
    const made = new uPlot(options(box.current, latest, setZoomed), data(props), box.current);
    plot.current = made;
    const observer = new ResizeObserver(() => box.current && made.setSize(room(box.current)));
    observer.observe(box.current);
    return () => {
      observer.disconnect();
      leave(made);
      made.destroy();
    };
  }, [shape]);

  const guides = JSON.stringify([props.thresholds, props.marks?.length]);
  useEffect(() => void (plot.current && feed(plot.current, props, zoomed)), [props.revision, props.x, shape, guides]);
  useEffect(() => plot.current?.redraw(false, false), [props.shown]);
  return html`<div class="chart" ref=${box} role="img" aria-label=${props.label}></div>`;
}

/** A chart that goes while the pointer is over it takes the cursor from all others. @param {uPlot} u */
function leave(u) {
  if ((u.cursor.left ?? -1) < 0) return;
  for (const name of [CURSOR, CURSOR_TIME]) for (const other of uPlot.sync(name).plots) other.setCursor({ left: -10, top: -10 });
}

/** @param {ChartProps} props @returns {uPlot.AlignedData} */
function data({ x, columns }) {
  return /** @type {uPlot.AlignedData} */ ([x, ...columns.map((column) => (column.length ? column : x.map(() => null)))]);
}

/** Keeps the part that somebody zoomed into. @param {uPlot} u @param {ChartProps} props @param {boolean} zoomed */
function feed(u, props, zoomed) {
  u.setData(data(props), !zoomed);
  if (zoomed) u.redraw();
}

/** @param {HTMLElement} box */
function room(box) {
  return { width: Math.max(80, box.clientWidth), height: Math.max(40, box.clientHeight) };
}

/**
 * @param {HTMLElement} box
 * @param {{current: ChartProps}} latest
 * @param {(zoomed: boolean) => void} setZoomed
 * @returns {uPlot.Options}
 */
function options(box, latest, setZoomed) {
  const { lines, time = false, fromZero = true, spikes = false } = latest.current;
  const axis = { stroke: color("ink-3"), font: '10px system-ui, "DejaVu Sans", sans-serif' };
  const grid = { stroke: color("line"), width: 1 };
  return {
    ...room(box),
    padding: [6, 8, 0, 0],
    legend: { show: false },
    // Seconds and node ids don't share a cursor.
    cursor: { sync: { key: time ? CURSOR_TIME : CURSOR }, points: { size: 6 }, drag: { x: true, y: false } },
    scales: { x: { time: false }, y: { range: (u, low, high) => yRange(low, (spikes ? ceilingOf(u) : null) ?? high, fromZero, latest.current) } },
    axes: [
      { ...axis, size: 18, gap: 2, grid: { show: false }, ticks: { show: false }, values: time ? seconds : undefined },
      { ...axis, size: 38, gap: 3, grid, ticks: { show: false }, splits: fewSplits },
    ],
    series: [{}, ...lines.map(series)],
    hooks: {
      draw: [(u) => drawGuides(u, latest.current), (u) => void (spikes && drawCutOff(u))],
      setCursor: [(u) => latest.current.onCursor?.(u.cursor.idx ?? null)],
      setSelect: [(u) => setZoomed(u.select.width > 0)],
      ready: [(u) => listen(u, latest, setZoomed)],
    },
  };
}

/** @param {Line} line @returns {uPlot.Series} */
function series({ label, token, kind = "line" }) {
  const stroke = color(token);
  const soft = `color-mix(in srgb, ${stroke} ${kind === "area" ? 22 : 80}%, transparent)`;
  const paths = kind === "bars" ? uPlot.paths.bars?.({ size: [0.8, 6, 1] }) : undefined;
  const fill = kind === "line" ? undefined : soft;
  return { label, stroke, fill, paths, width: kind === "bars" ? 0 : 1.25, points: { show: false }, spanGaps: true };
}

/** Two or three lines say enough in a small chart. @param {uPlot} _ @param {number} __ @param {number} low @param {number} high */
function fewSplits(_, __, low, high) {
  const raw = (high - low) / 3;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= raw) ?? raw;
  const splits = [];
  for (let at = Math.ceil(low / step) * step; at <= high; at += step) splits.push(Number(at.toPrecision(12)));
  return splits;
}

/**
 * What stands below a chart over time. The label at its left end would touch that of the other axis.
 * @param {Pick<uPlot, "valToPos">} u @param {number[]} splits
 */
export function seconds(u, splits) {
  return splits.map((at) => (u.valToPos(at, "x") < HALF_LABEL_PX ? "" : Math.abs(at) >= 120 ? `${Math.floor(at / 60)}:${String(at % 60).padStart(2, "0")}` : `${at} s`));
}

/** @param {uPlot} u @param {{current: ChartProps}} latest @param {(zoomed: boolean) => void} setZoomed */
function listen(u, latest, setZoomed) {
  let pressedAt = 0;
  u.over.addEventListener("pointerdown", (event) => (pressedAt = event.clientX));
  u.over.addEventListener("click", (event) => {
    const dragged = Math.abs(event.clientX - pressedAt) > 3;
    if (!dragged && u.cursor.idx !== null && u.cursor.idx !== undefined) latest.current.onPick?.(u.cursor.idx);
  });
  listenForDrag(u, latest);
  u.over.addEventListener("dblclick", () => setZoomed(false));
}
