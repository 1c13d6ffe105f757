// The cloud of a node, turned and zoomed by hand, from which points are picked by a click.
import { useEffect, useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { address, file } from "../api.js";
import { drawCloud, firstView, pointNear, project, REACH, shifted, turned, zoomed } from "../orbit.js";
import { color } from "../theme.js";
import { useFetched } from "./use.js";

/** @typedef {import("../orbit.js").Cloud} Cloud */
/** @typedef {import("../orbit.js").View} View */
/** @typedef {{number: number, at: number[]}} Mark */
/** @typedef {PointerEvent & {currentTarget: HTMLCanvasElement}} Pointer */

const ROW_BYTES = 16;
/** A pointer that moves farther than this, pixels, turns the cloud and picks nothing. */
const STILL = 4;
const TURN = 0.008;
const KEYS = /** @type {Record<string, [number, number]>} */ ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] });

/** @param {ArrayBuffer} rows of GET .../points @returns {Cloud} */
export function cloudOf(rows) {
  const count = Math.floor(rows.byteLength / ROW_BYTES);
  const [numbers, bytes] = [new Float32Array(rows), new Uint8Array(rows)];
  const cloud = { points: new Float32Array(3 * count), colours: new Uint8Array(3 * count), count };
  for (let k = 0; k < count; k += 1) {
    cloud.points.set(numbers.subarray(4 * k, 4 * k + 3), 3 * k);
    cloud.colours.set(bytes.subarray(ROW_BYTES * k + 12, ROW_BYTES * k + 15), 3 * k);
  }
  return cloud;
}

/** @param {{map: string, id: number, marks: Mark[], onPick: (at: number[]) => void}} props */
export function CloudPicker({ map, id, marks, onPick }) {
  const { data, error } = useFetched(async () => cloudOf(await (await file(address("api", "maps", map, "nodes", id, "points"))).arrayBuffer()), [map, id]);
  if (error.value) return html`<p class="quiet">No cloud of node ${id}: ${error.value.message}.</p>`;
  if (!data.value) return html`<p class="quiet">Loading…</p>`;
  if (!data.value.count) return html`<p class="quiet">No point of node ${id} has depth.</p>`;
  return h(Picture, { key: id, id, cloud: data.value, marks, onPick });
}

/** @param {{id: number, cloud: Cloud, marks: Mark[], onPick: (at: number[]) => void, key?: unknown}} props */
function Picture({ id, cloud, marks, onPick }) {
  const canvas = useRef(/** @type {HTMLCanvasElement | null} */ (null));
  const shown = useRef(/** @type {Int32Array} */ (new Int32Array()));
  const [view, setView] = useState(() => firstView(cloud));
  const [width, setWidth] = useState(0);
  const [byKeys, setByKeys] = useState(false);
  useEffect(() => {
    const element = /** @type {HTMLCanvasElement} */ (canvas.current);
    const observer = new ResizeObserver(() => setWidth(element.clientWidth));
    observer.observe(element);
    const wheel = (/** @type {WheelEvent} */ event) => (event.preventDefault(), setView((now) => zoomed(now, Math.exp(0.0015 * event.deltaY))));
    element.addEventListener("wheel", wheel, { passive: false });
    return () => (observer.disconnect(), element.removeEventListener("wheel", wheel));
  }, []);
  useEffect(() => {
    if (width && canvas.current) shown.current = paint(canvas.current, width, cloud, view, marks, byKeys);
  }, [width, cloud, view, marks, byKeys]);
  const pick = (/** @type {number} */ x, /** @type {number} */ y, reach = REACH) => {
    const element = /** @type {HTMLCanvasElement} */ (canvas.current);
    const scale = element.width / element.clientWidth;
    const k = pointNear(shown.current, element.width, x * scale, y * scale, reach * scale);
    if (k >= 0) onPick([...cloud.points.subarray(3 * k, 3 * k + 3)]);
  };
  const hands = useHands(setView, pick);
  const key = (/** @type {KeyboardEvent} */ event) => {
    const step = KEYS[event.key];
    if (step) setView(event.shiftKey ? shifted(view, -0.05 * step[0], -0.05 * step[1]) : turned(view, -0.06 * step[0], 0.06 * step[1]));
    else if (event.key === "+" || event.key === "-") setView(zoomed(view, event.key === "+" ? 0.9 : 1.1));
    else if (event.key === "Enter") pick(width / 2, (canvas.current?.clientHeight ?? 0) / 2, width / 4);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return html`<canvas
    ref=${canvas}
    class="cloud-picker"
    tabindex="0"
    role="img"
    aria-label=${`Pick points of the cloud of node ${id}`}
    title="Drag turns, Shift or the right button shifts, the wheel zooms; arrows, + and - too, and Enter picks in the middle"
    onKeyDown=${key}
    onFocus=${(/** @type {{currentTarget: HTMLElement}} */ { currentTarget }) => setByKeys(currentTarget.matches(":focus-visible"))}
    onBlur=${() => setByKeys(false)}
    onContextMenu=${(/** @type {Event} */ event) => event.preventDefault()}
    ...${hands}
  ></canvas>`;
}

/**
 * One pointer turns, with Shift or the right button it shifts; two of them zoom and shift; one that stays still picks.
 * @param {(change: (view: View) => View) => void} setView
 * @param {(x: number, y: number) => void} pick
 */
function useHands(setView, pick) {
  const down = useRef(/** @type {Map<number, {x: number, y: number}>} */ (new Map()));
  const way = useRef(0);
  const place = (/** @type {Pointer} */ event) => ({ x: event.offsetX, y: event.offsetY });
  return {
    onPointerDown: (/** @type {Pointer} */ event) => {
      event.currentTarget.setPointerCapture(event.pointerId);
      if (!down.current.size) way.current = 0;
      down.current.set(event.pointerId, place(event));
    },
    onPointerMove: (/** @type {Pointer} */ event) => {
      const last = down.current.get(event.pointerId);
      if (!last) return;
      const now = place(event);
      const [dx, dy, height] = [now.x - last.x, now.y - last.y, event.currentTarget.clientHeight];
      const other = [...down.current].find(([pointer]) => pointer !== event.pointerId)?.[1];
      down.current.set(event.pointerId, now);
      way.current += Math.hypot(dx, dy) + (other ? STILL : 0);
      if (way.current <= STILL) return;
      if (other) {
        const apart = (/** @type {{x: number, y: number}} */ at) => Math.max(1, Math.hypot(at.x - other.x, at.y - other.y));
        setView((view) => shifted(zoomed(view, apart(last) / apart(now)), dx / height / 2, dy / height / 2));
      } else if (event.shiftKey || event.buttons === 2) setView((view) => shifted(view, dx / height, dy / height));
      else setView((view) => turned(view, TURN * dx, -TURN * dy));
    },
    onPointerUp: (/** @type {Pointer} */ event) => {
      const was = down.current.delete(event.pointerId);
      if (was && !down.current.size && way.current <= STILL && event.button === 0) pick(event.offsetX, event.offsetY);
    },
    onPointerCancel: (/** @type {Pointer} */ event) => void down.current.delete(event.pointerId),
  };
}

/**
 * @param {HTMLCanvasElement} canvas
 * @param {number} width in CSS
 * @param {Cloud} cloud
 * @param {View} view
 * @param {Mark[]} marks
 * @param {boolean} withMiddle whether it is shown where keys pick
 */
function paint(canvas, width, cloud, view, marks, withMiddle) {
  const scale = Math.min(2, devicePixelRatio);
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(canvas.clientHeight * scale);
  const ctx = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const image = ctx.createImageData(canvas.width, canvas.height);
  const shown = drawCloud(image, cloud, view);
  ctx.putImageData(image, 0, 0);
  ctx.font = `700 ${13 * scale}px ${getComputedStyle(document.body).fontFamily}`;
  ctx.lineJoin = "round";
  for (const { number, at } of marks) {
    const seen = project(view, canvas.width, canvas.height, at);
    if (!seen) continue;
    ctx.beginPath();
    ctx.arc(seen.x, seen.y, 5 * scale, 0, 2 * Math.PI);
    ctx.strokeStyle = "#000";
    ctx.lineWidth = 4 * scale;
    ctx.stroke();
    ctx.strokeText(String(number), seen.x + 7 * scale, seen.y - 5 * scale);
    ctx.strokeStyle = ctx.fillStyle = color("picked");
    ctx.lineWidth = 2 * scale;
    ctx.stroke();
    ctx.fillText(String(number), seen.x + 7 * scale, seen.y - 5 * scale);
  }
  if (withMiddle) {
    const [x, y, arm] = [canvas.width / 2, canvas.height / 2, 8 * scale];
    const cross = new Path2D(`M${x - arm} ${y}H${x + arm}M${x} ${y - arm}V${y + arm}`);
    for (const [style, line] of /** @type {[string, number][]} */ ([["#000", 4], [color("picked"), 2]])) {
      [ctx.strokeStyle, ctx.lineWidth] = [style, line * scale];
      ctx.stroke(cross);
    }
  }
  return shown;
}
