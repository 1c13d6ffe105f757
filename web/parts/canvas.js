// A canvas as wide as its place, in the device's own pixels, drawn anew when its size or its content changes.
import { useEffect, useRef, useState } from "preact/hooks";
import { html } from "../html.js";
import { useWidth } from "./use.js";

/** @typedef {(ctx: CanvasRenderingContext2D, width: number, height: number) => void} Draw in CSS pixels */

/**
 * @typedef {object} CanvasProps
 * @property {string} label what it shows, for screen readers
 * @property {number} aspect width / height
 * @property {Draw} draw
 * @property {unknown[]} dependencies draw again when one changes
 * @property {number | null} [pixels] width in its own pixels, when it is saved; as wide as shown where it has none
 * @property {(place: Place | null) => void} [onPoint] where the pointer is; null once it has left
 */

/** @typedef {[number, number]} Place x and y from 0 to 1, from the upper left corner */

/** How to draw what a canvas shows in another size. @type {WeakMap<HTMLCanvasElement, () => HTMLCanvasElement>} */
const copies = new WeakMap();

/** What a canvas shows, in the pixels of the image itself. @param {HTMLCanvasElement} canvas */
export function pictureOf(canvas) {
  return copies.get(canvas)?.() ?? canvas;
}

/** @param {CanvasProps} props */
export function Canvas(props) {
  const { label, aspect, draw, dependencies, pixels, onPoint } = props;
  const canvas = useRef(/** @type {HTMLCanvasElement | null} */ (null));
  const width = useWidth(canvas);
  useEffect(() => {
    if (!canvas.current || width <= 0) return;
    paint(canvas.current, width, Math.round(width / aspect), draw);
    copies.set(canvas.current, () => {
      const copy = document.createElement("canvas");
      const wide = pixels ?? width;
      paint(copy, wide, Math.round(wide / aspect), draw, 1);
      return copy;
    });
  }, [width, aspect, pixels, ...dependencies]);
  const moved = onPoint && ((/** @type {PointerEvent} */ event) => onPoint(placeOf(event)));
  const busy = "pixels" in props && !pixels;
  return html`<canvas ref=${canvas} role="img" aria-label=${label} aria-busy=${busy} onPointerMove=${moved} onPointerLeave=${onPoint && (() => onPoint(null))}></canvas>`;
}

/** @param {PointerEvent} event @returns {Place} */
function placeOf(event) {
  const box = /** @type {HTMLElement} */ (event.currentTarget).getBoundingClientRect();
  const share = (/** @type {number} */ from, /** @type {number} */ length) => Math.max(0, Math.min(1, from / length));
  return [share(event.clientX - box.left, box.width), share(event.clientY - box.top, box.height)];
}

/** @param {HTMLCanvasElement} canvas @param {number} width @param {number} height @param {Draw} draw @param {number} [scale] device pixels in one of CSS */
function paint(canvas, width, height, draw, scale = devicePixelRatio) {
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  const ctx = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  ctx.scale(scale, scale);
  draw(ctx, width, height);
}

/**
 * An image once it is here; null until then, and when there is none.
 * @param {string | null} source
 */
export function useImage(source) {
  const [image, setImage] = useState(/** @type {HTMLImageElement | null} */ (null));
  const [missing, setMissing] = useState(false);
  useEffect(() => {
    if (!source) return undefined;
    const made = new Image();
    let wanted = true;
    made.onload = () => wanted && (setImage(made), setMissing(false));
    made.onerror = () => wanted && (setImage(null), setMissing(true));
    made.src = source;
    return () => void (wanted = false);
  }, [source]);
  return { image, missing };
}
