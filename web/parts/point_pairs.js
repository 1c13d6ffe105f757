// Points picked by hand in two images: first in the left one, then the same point in the right one.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { address } from "../api.js";
import * as text from "../format.js";
import { Button } from "./button.js";
import { useImage } from "./canvas.js";
import { Lightbox } from "./lightbox.js";

/** @typedef {number[]} Point x and y in pixels */
/** @typedef {{left: Point, right: Point | null}} Picked */

/** @param {{map: string, from: number, to: number, points: Picked[], residuals: number[] | null, onChange: (points: Picked[]) => void}} props */
export function PointPairs({ map, from, to, points, residuals, onChange }) {
  const open = points.findIndex(({ right }) => right === null);
  const left = (/** @type {Point} */ at) => open < 0 && onChange([...points, { left: at, right: null }]);
  const right = (/** @type {Point} */ at) => open >= 0 && onChange(points.map((one, k) => (k === open ? { ...one, right: at } : one)));
  const asked = open < 0 ? `Click a point in the image of node ${from}` : `Click the same point in the image of node ${to}`;
  const [large, setLarge] = useState(false);
  const picking = html`<div>
    <p class="small quiet" id="points-asked">${asked}; ${text.plural(points.length - (open < 0 ? 0 : 1), "pair")}, at least 3, not on one line.</p>
    <div class="point-images">
      ${h(Side, { map, id: from, marks: points.map((one) => one.left), onPick: left })}
      ${h(Side, { map, id: to, marks: points.flatMap((one) => (one.right ? [one.right] : [])), onPick: right })}
    </div>
    <ol class="point-list small">
      ${points.map(
        (_, k) => html`<li key=${k}>
          Pair ${k + 1} <span class="quiet">${residuals && residuals[k] !== undefined ? `${text.length(residuals[k])} off` : ""}</span>
          ${h(Button, { icon: "close", kind: "bare", hint: `Remove pair ${k + 1}`, onClick: () => onChange(points.filter((__, other) => other !== k)) })}
        </li>`,
      )}
    </ol>
    ${!large && h(Button, { icon: "expand", label: "Pick in large images", onClick: () => setLarge(true) })}
  </div>`;
  if (!large) return picking;
  return h(Lightbox, { title: `The same points in nodes ${from} and ${to}`, savable: false, close: () => setLarge(false), children: picking });
}

/** @param {{map: string, id: number, marks: Point[], onPick: (at: Point) => void}} props */
function Side({ map, id, marks, onPick }) {
  const { image, missing } = useImage(address("api", "maps", map, "nodes", id, "image"));
  if (missing) return html`<p class="quiet">No image is stored for node ${id}.</p>`;
  if (!image) return html`<p class="quiet">Loading…</p>`;
  const [width, height] = [image.naturalWidth, image.naturalHeight];
  const pick = (/** @type {MouseEvent} */ event) => {
    const box = /** @type {SVGElement} */ (event.currentTarget).getBoundingClientRect();
    onPick([((event.clientX - box.left) / box.width) * width - 0.5, ((event.clientY - box.top) / box.height) * height - 0.5]);
  };
  return html`<svg viewBox=${`0 0 ${width} ${height}`} role="img" aria-label=${`Pick points of node ${id}`} onClick=${pick}>
    <image href=${image.src} width=${width} height=${height} />
    ${marks.map(
      ([x, y], k) => html`<g key=${k} class="point-mark">
        <circle cx=${x + 0.5} cy=${y + 0.5} r=${width / 80} />
        <text x=${x + width / 60} y=${y} font-size=${width / 22}>${k + 1}</text>
      </g>`,
    )}
  </svg>`;
}
