// Files that the page makes itself: tables as CSV, charts as PNG.
import { color } from "./theme.js";

const TITLE_PX = 26;
const KEPT_MS = 60_000;

/** @param {Blob} content @param {string} name of the file */
export function save(content, name) {
  const url = URL.createObjectURL(content);
  const link = document.createElement("a");
  [link.href, link.download] = [url, name.replace(/[^\p{L}\p{N}._-]+/gu, "-")];
  link.click();
  // Some browsers read it only after this.
  setTimeout(() => URL.revokeObjectURL(url), KEPT_MS);
}

/**
 * Columns under their names, one row in each line; what is not known stays empty (RFC 4180).
 * @param {[name: string, values: (number | null | undefined)[]][]} columns
 */
export function csv(columns) {
  const quoted = (/** @type {string} */ name) => (/[",\n]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name);
  const rows = Math.max(0, ...columns.map(([, values]) => values.length));
  const lines = [columns.map(([name]) => quoted(name)).join(",")];
  for (let row = 0; row < rows; row += 1) lines.push(columns.map(([, values]) => values[row] ?? "").join(","));
  return `${lines.join("\r\n")}\r\n`;
}

/** Pictures beside each other in one PNG, each in its own size. @param {HTMLCanvasElement[]} pictures @param {string} name of the file */
export function savePictures(pictures, name) {
  const width = pictures.reduce((sum, one) => sum + one.width, 0);
  const canvas = new OffscreenCanvas(width, Math.max(...pictures.map(({ height }) => height)));
  const ctx = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));
  let left = 0;
  for (const picture of pictures) {
    ctx.drawImage(picture, left, 0);
    left += picture.width;
  }
  void saveDrawn(canvas, name);
}

/** What a chart shows, on the page's ground with its title. @param {HTMLCanvasElement} chart @param {string} title @param {string} name */
export function savePicture(chart, title, name) {
  const scale = devicePixelRatio;
  const canvas = new OffscreenCanvas(chart.width, chart.height + TITLE_PX * scale);
  const ctx = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));
  ctx.fillStyle = color("panel");
  ctx.fillRect(0, 0, canvas.width, canvas.height);
  ctx.fillStyle = color("ink");
  ctx.font = `600 ${13 * scale}px system-ui, "DejaVu Sans", sans-serif`;
  ctx.fillText(title, 10 * scale, 18 * scale);
  ctx.drawImage(chart, 0, TITLE_PX * scale);
  void saveDrawn(canvas, name);
}

/** Other than toBlob() this does not wait for a moment in which a browser has nothing to draw. @param {OffscreenCanvas} canvas @param {string} name */
async function saveDrawn(canvas, name) {
  save(await canvas.convertToBlob({ type: "image/png" }), name);
}
