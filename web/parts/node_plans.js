// A node's scan and local grid from above: the base in the middle, looking up.
import { h, html } from "../html.js";
import { address } from "../api.js";
import * as text from "../format.js";
import { color } from "../theme.js";
import { remembered } from "../prefs.js";
import { link } from "../router.js";
import { Canvas, useImage } from "./canvas.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {import("../store.js").Schemas["GridFacts"]} Grid */

const open = remembered("node-plans", true);
/** Rings are a step of one of these apart, metres. */
const STEPS = [0.25, 0.5, 1, 2, 5, 10, 20, 50, 100, 500];

/** @param {{map: string, node: NodeDetail}} props */
export function NodePlans({ map, node }) {
  const { scan, grid } = node.sensors;
  const cells = grid ? grid.ground + grid.obstacles + grid.empty : 0;
  if (!scan?.points && !cells) return null;
  return html`<details class="fold" open=${open.value} onToggle=${(/** @type {{currentTarget: HTMLDetailsElement}} */ { currentTarget }) => (open.value = currentTarget.open)}>
    <summary>From above <span class="quiet">${[scan?.points && "scan", cells && "local grid"].filter(Boolean).join(" and ")}</span></summary>
    <div class="pictures plans">
      ${scan && scan.points > 0 && h(Plan, { map, node: node.id, what: "scan", reach: scan.reach_m, caption: scanCaption(scan) })}
      ${grid && cells > 0 && h(Plan, { map, node: node.id, what: "grid", reach: grid.reach_m, caption: gridCaption(grid), query: gridState(grid) })}
    </div>
    ${grid && cells > 0 && html`<p class="small"><a id="node-regrid" href=${link({ view: "loops", key: null, query: { tab: "jobs", work: "regrid", first: String(node.id), last: String(node.id) } })}>Make the local grid anew, with other parameters</a></p>`}
  </details>`;
}

/** @param {NonNullable<NodeDetail["sensors"]["scan"]>} scan */
function scanCaption({ points, intensities }) {
  return html`${text.plural(points, "point")}, ${intensities ? "coloured by intensity" : "coloured by height"}`;
}

/** A grid that was made anew has another picture. @param {Grid} grid */
export const gridState = ({ ground, obstacles, empty, cell_size_m }) => `cells=${ground}-${obstacles}-${empty}-${cell_size_m}`;

/** @param {Grid} grid */
export function gridCaption({ ground, obstacles, empty, cell_size_m }) {
  const part = (/** @type {string} */ name, /** @type {number} */ count) => count > 0 && html`<span><i class=${`mark cell-${name}`} aria-hidden="true"></i>${text.whole(count)} ${name}</span>`;
  return html`<span class="plan-legend">${part("ground", ground)}${part("obstacle", obstacles)}${part("empty", empty)}<span>cells of ${text.length(cell_size_m)}</span></span>`;
}

/**
 * @param {{map: string, node: number, what: "scan" | "grid", reach: number, caption: import("../html.js").Children, query?: string}} props
 *   query: of the picture's address, another for each state that it has
 */
export function Plan({ map, node, what, reach, caption, query = "" }) {
  const { image, missing } = useImage(`${address("api", "maps", map, "nodes", node, `${what}.png`)}${query && `?${query}`}`);
  if (missing) return html`<div class="picture-none quiet">It can't be shown: it is damaged.</div>`;
  return html`<figure class="plan">
    ${h(Canvas, {
      label: `${what === "scan" ? "Scan" : "Local grid"} of node ${node} from above`,
      aspect: 1,
      dependencies: [image, reach],
      draw: (ctx, width) => draw(ctx, width, image, reach),
    })}
    <figcaption class="small quiet">${caption}</figcaption>
  </figure>`;
}

/** @param {CanvasRenderingContext2D} ctx @param {number} side @param {HTMLImageElement | null} image @param {number} reach metres from the middle to an edge */
function draw(ctx, side, image, reach) {
  const middle = side / 2;
  const step = STEPS.find((one) => reach / one < 5) ?? reach;
  ctx.strokeStyle = color("line-strong");
  ctx.fillStyle = color("ink-2");
  ctx.lineWidth = 0.8;
  ctx.font = `10px ${getComputedStyle(document.body).fontFamily}`;
  ctx.imageSmoothingEnabled = Boolean(image && image.naturalWidth > side);
  for (let at = step; at < reach * 1.4; at += step) {
    ctx.beginPath();
    ctx.arc(middle, middle, (at / reach) * middle, 0, 2 * Math.PI);
    ctx.stroke();
  }
  if (image) ctx.drawImage(image, 0, 0, side, side);
  ctx.fillText(`rings ${text.length(step)}`, 5, side - 6);
  // The base, its x axis up.
  ctx.fillStyle = color("accent");
  ctx.beginPath();
  ctx.moveTo(middle, middle - 7);
  ctx.lineTo(middle - 4.5, middle + 5);
  ctx.lineTo(middle + 4.5, middle + 5);
  ctx.fill();
}
