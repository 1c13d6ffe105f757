// Points picked by hand in two images or clouds: first in the left one, then the same point in the right one.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { address } from "../api.js";
import * as text from "../format.js";
import { Button, Chip } from "./button.js";
import { useImage } from "./canvas.js";
import { CloudPicker } from "./cloud_picker.js";
import { Lightbox } from "./lightbox.js";

/** @typedef {number[]} Point x and y in pixels of the image, or x, y and z in metres of the cloud */
/** @typedef {{left: Point, right: Point | null}} Picked */
/** @typedef {"images" | "clouds"} Where */

/** @param {{map: string, from: number, to: number, points: Picked[], residuals: number[] | null, onChange: (points: Picked[]) => void}} props */
export function PointPairs({ map, from, to, points, residuals, onChange }) {
  const [where, setWhere] = useState(/** @type {Where} */ ("images"));
  const [large, setLarge] = useState(false);
  const open = points.findIndex(({ right }) => right === null);
  const left = (/** @type {Point} */ at) => open < 0 && onChange([...points, { left: at, right: null }]);
  const right = (/** @type {Point} */ at) => open >= 0 && onChange(points.map((one, k) => (k === open ? { ...one, right: at } : one)));
  const what = where === "images" ? "image" : "cloud";
  const asked = open < 0 ? `Click a point in the ${what} of node ${from}` : `Click the same point in the ${what} of node ${to}`;
  const side = where === "images" ? ImageSide : CloudPicker;
  const picking = html`<div>
    <div class="form-row" role="group" aria-label="Where points are picked">
      ${h(Chip, { label: "Images", hint: "Pixels with depth", on: where === "images", onChange: () => setWhere("images") })}
      ${h(Chip, { label: "Clouds", hint: "Points of depth images or of scanners; a pair may have one of each", on: where === "clouds", onChange: () => setWhere("clouds") })}
    </div>
    <p class="small quiet" id="points-asked">${asked}; ${text.plural(points.length - (open < 0 ? 0 : 1), "pair")}, at least 3, not on one line.</p>
    <div class="point-images">
      ${h(side, { map, id: from, marks: marksOf(points.map((one) => one.left), where), onPick: left })}
      ${h(side, { map, id: to, marks: marksOf(points.map((one) => one.right), where), onPick: right })}
    </div>
    <ol class="point-list small">
      ${points.map(
        (_, k) => html`<li key=${k}>
          Pair ${k + 1} <span class="quiet">${residuals && residuals[k] !== undefined ? `${text.length(residuals[k])} off` : ""}</span>
          ${h(Button, { icon: "close", kind: "bare", hint: `Remove pair ${k + 1}`, onClick: () => onChange(points.filter((__, other) => other !== k)) })}
        </li>`,
      )}
    </ol>
    ${!large && h(Button, { icon: "expand", label: `Pick in large ${where}`, onClick: () => setLarge(true) })}
  </div>`;
  if (!large) return picking;
  return h(Lightbox, { title: `The same points in nodes ${from} and ${to}`, savable: false, close: () => setLarge(false), children: picking });
}

/** What was picked there, with the numbers of the pairs. @param {(Point | null)[]} points @param {Where} where */
function marksOf(points, where) {
  const length = where === "images" ? 2 : 3;
  return points.flatMap((at, k) => (at?.length === length ? [{ number: k + 1, at }] : []));
}

/** @param {{map: string, id: number, marks: import("./cloud_picker.js").Mark[], onPick: (at: Point) => void}} props */
function ImageSide({ map, id, marks, onPick }) {
  const { image, missing } = useImage(address("api", "maps", map, "nodes", id, "image"));
  if (missing) return html`<p class="quiet">No image is stored for node ${id}: pick in the clouds.</p>`;
  if (!image) return html`<p class="quiet">Loading…</p>`;
  const [width, height] = [image.naturalWidth, image.naturalHeight];
  const pick = (/** @type {MouseEvent} */ event) => {
    const box = /** @type {SVGElement} */ (event.currentTarget).getBoundingClientRect();
    onPick([((event.clientX - box.left) / box.width) * width - 0.5, ((event.clientY - box.top) / box.height) * height - 0.5]);
  };
  return html`<svg viewBox=${`0 0 ${width} ${height}`} role="img" aria-label=${`Pick points of node ${id}`} onClick=${pick}>
    <image href=${image.src} width=${width} height=${height} />
    ${marks.map(
      ({ number, at: [x, y] }) => html`<g key=${number} class="point-mark">
        <circle cx=${x + 0.5} cy=${y + 0.5} r=${width / 80} />
        <text x=${x + width / 60} y=${y} font-size=${width / 22}>${number}</text>
      </g>`,
    )}
  </svg>`;
}
