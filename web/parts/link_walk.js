// Where a link stands among all of its class, and the way to the next: odometry's links, or the loops of the graph.
import { html } from "../html.js";
import * as text from "../format.js";
import { go, link, route } from "../router.js";

/** @typedef {import("../store.js").Schemas["LinkWalk"]} Walk */

/** Show the next link of its class, or the one before. @param {Walk | undefined} walk @param {number} by */
export function walkOn(walk, by) {
  const pair = by > 0 ? walk?.next : walk?.previous;
  if (pair) go({ view: "loops", key: pair.join("-"), query: Object.fromEntries(route.value.query) });
}

/** @param {{walk: Walk}} props */
export function WalkLine({ walk }) {
  const { loops, index, total, previous, next, other } = walk;
  const to = (/** @type {number[] | null} */ pair, /** @type {string} */ label, /** @type {string} */ hint) =>
    pair
      ? html`<a href=${link({ view: "loops", key: pair.join("-"), query: Object.fromEntries(route.value.query) })} title=${hint} aria-label=${hint}>${label}</a>`
      : html`<span class="quiet" aria-hidden="true">${label}</span>`;
  const name = loops ? "loop" : "odometry link";
  const place = index === null ? `Not among the ${text.plural(total, name)}` : `${loops ? "Loop" : "Odometry link"} ${text.whole(index)} of ${text.whole(total)}`;
  return html`<nav class="walk small" aria-label="Links along the path">
    <span class="quiet" title="In the order of nodes; the queue has an order of its own">${place} along the path</span>
    ${to(previous, "‹ before", `The ${name} before along the path`)} ${to(next, "after ›", `The ${name} after it along the path`)}
    <span class="grow"></span>
    ${to(other, loops ? "odometry here" : "loops near by", loops ? "The odometry link at this node" : "The next loop along the path")}
  </nav>`;
}
