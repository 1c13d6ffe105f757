// Update time and working memory of both replays over the nodes of the map.
import { useMemo } from "preact/hooks";
import { h, html } from "../html.js";
import { Chart } from "./chart.js";

/** @typedef {import("./trial.js").Comparison} Comparison */
/** @typedef {import("./trial.js").Side} Side */

const LINES = [
  { label: "as it was", token: "ink-3" },
  { label: "tried", token: "accent" },
];

/** @param {{found: Comparison}} props */
export function TrialCharts({ found: { baseline, tried } }) {
  const { x, time, memory } = useMemo(() => {
    const ids = [...new Set([...baseline.update_ids, ...tried.update_ids])].sort((a, b) => a - b);
    const both = (/** @type {"update_ms" | "wm"} */ name) => [baseline, tried].map((side) => along(ids, side, name));
    return { x: ids, time: both("update_ms"), memory: both("wm") };
  }, [baseline, tried]);
  const legend = html`<span class="ink-before">as it was</span> <span class="ink-accent">tried</span>`;
  return html`<div class="trial-charts">
    <figure>
      <figcaption class="small"><b>Update time, ms</b> ${legend}</figcaption>
      ${h(Chart, { label: "Update time of both replays over nodes", lines: LINES, x, columns: time, revision: 1, spikes: true })}
    </figure>
    <figure>
      <figcaption class="small"><b>WM, nodes</b> ${legend}</figcaption>
      ${h(Chart, { label: "Working memory of both replays over nodes", lines: LINES, x, columns: memory, revision: 1 })}
    </figure>
  </div>`;
}

/** @param {number[]} ids @param {Side} side @param {"update_ms" | "wm"} name @returns {(number | null)[]} */
function along(ids, side, name) {
  const values = new Map(side.update_ids.map((id, row) => [id, side[name][row]]));
  return ids.map((id) => values.get(id) ?? null);
}
