// What an update believed about where it was: a bar for each place, and the threshold that all of them are held against.
import { h, html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { go } from "../router.js";
import { inForce } from "../store.js";
import { Chart } from "./chart.js";
import { useFetched } from "./use.js";

/** @param {{map: string, update: number, place: number}} props place: the node that the loop leads to */
export function Belief({ map, update, place }) {
  const { data, error } = useFetched((signal) => get("/api/maps/{map}/hypothesis/{node_id}", { path: { map, node_id: update }, signal }), [map, update]);
  const threshold = Number(inForce("Rtabmap/LoopThr") ?? NaN);
  if (error.value) return html`<p class="quiet small belief-none">${error.value.message}</p>`;
  const found = data.value;
  if (!found) return null;
  const at = found.ids.indexOf(place);
  const own = at < 0 ? null : found.posterior[at];
  return html`<figure class="belief" id="belief">
    <figcaption class="small">
      <b>Belief of update ${update}</b>
      <span title="The places together, 1 minus the virtual place: this is what LoopThr is compared with">all places <b>${text.fixed(found.value)}</b></span>
      <span class="ink-loop" title="The place that the loop leads to">▾ node ${place} <b>${text.fixed(own)}</b></span>
      <span class="quiet" title="Of being nowhere that is known">nowhere ${text.fixed(found.virtual_place)}</span>
      <span class="ink-warn">LoopThr ${text.short(threshold)}</span>
    </figcaption>
    ${h(Chart, {
      label: `Belief of update ${update} over places`,
      lines: [{ label: "posterior", token: "accent", kind: "bars" }],
      x: found.ids,
      columns: [found.posterior],
      revision: update,
      thresholds: Number.isFinite(threshold) ? [{ value: threshold, token: "warn" }] : [],
      marks: at < 0 ? [] : [{ at: place, height: found.posterior[at] }],
      onPick: (index) => go({ view: "nodes", key: found.ids[index] }),
    })}
  </figure>`;
}
