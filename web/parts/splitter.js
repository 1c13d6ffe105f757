// A bar between two areas: drag it, or focus it and use the arrow keys.
import { html } from "../html.js";

const STEP_PX = 16;

/**
 * @typedef {object} SplitterProps
 * @property {string} label what gets larger or smaller
 * @property {"vertical" | "horizontal"} orientation of the bar; the area behind it (right of or below it) is sized
 * @property {import("@preact/signals").Signal<number>} size in pixels
 * @property {number} min
 * @property {() => number} max
 */

/** @param {SplitterProps} props */
export function Splitter(props) {
  const { label, orientation, size, min, max } = props;
  return html`<div
    class=${`splitter splitter-${orientation}`}
    role="separator"
    tabindex="0"
    aria-label=${label}
    aria-orientation=${orientation}
    aria-valuenow=${Math.round(size.value)}
    aria-valuemin=${min}
    aria-valuemax=${Math.round(max())}
    onPointerDown=${(/** @type {PointerEvent} */ event) => drag(event, props)}
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => nudge(event, props)}
  ></div>`;
}

/** @param {SplitterProps} props @param {number} wanted */
function resize({ size, min, max }, wanted) {
  size.value = Math.round(Math.max(min, Math.min(max(), wanted)));
}

/** @param {PointerEvent} event @param {SplitterProps} props */
function drag(event, props) {
  const bar = /** @type {HTMLElement} */ (event.currentTarget);
  const along = props.orientation === "vertical" ? "clientX" : "clientY";
  const from = event[along] + props.size.value;
  const onMove = (/** @type {PointerEvent} */ moved) => resize(props, from - moved[along]);
  bar.setPointerCapture(event.pointerId);
  // Frames would swallow the pointer while it passes over them.
  document.body.classList.add("dragging");
  bar.addEventListener("pointermove", onMove);
  bar.addEventListener("lostpointercapture", () => stop(bar, onMove), { once: true });
}

/** @param {HTMLElement} bar @param {(event: PointerEvent) => void} onMove */
function stop(bar, onMove) {
  document.body.classList.remove("dragging");
  bar.removeEventListener("pointermove", onMove);
}

/** @param {KeyboardEvent} event @param {SplitterProps} props */
function nudge(event, props) {
  const larger = props.orientation === "vertical" ? "ArrowLeft" : "ArrowUp";
  const smaller = props.orientation === "vertical" ? "ArrowRight" : "ArrowDown";
  if (event.key !== larger && event.key !== smaller) return;
  event.preventDefault();
  resize(props, props.size.value + (event.key === larger ? STEP_PX : -STEP_PX));
}
