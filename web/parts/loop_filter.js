// Which loops the queue shows.
import { h, html } from "../html.js";
import { Chip } from "./button.js";

/** @typedef {{states: string[], type: string, minInliers: number}} LoopFilterState */

const STATES = /** @type {[string, string][]} */ ([
  ["accepted", "Accepted"],
  ["refused", "Refused"],
  ["approved", "Approved"],
  ["rejected", "Rejected"],
  ["added", "By hand"],
]);
const TYPES = /** @type {[string, string][]} */ ([
  ["", "All types"],
  ["GlobalClosure", "Global"],
  ["LocalSpaceClosure", "Proximity"],
  ["UserClosure", "By hand"],
]);
const INLIERS = [0, 20, 40, 80];

/** @param {{filter: LoopFilterState, counts: Record<string, number>, onChange: (filter: LoopFilterState) => void}} props */
export function LoopFilter({ filter, counts, onChange }) {
  const toggle = (/** @type {string} */ state, /** @type {boolean} */ on) => {
    const others = filter.states.filter((one) => one !== state);
    onChange({ ...filter, states: on ? [...others, state] : others });
  };
  return html`<div class="view-tools filters" role="group" aria-label="Filter">
    ${STATES.filter(([state]) => counts[state] || filter.states.includes(state)).map(([state, label]) =>
      h(Chip, { key: state, label: `${label} ${counts[state] ?? 0}`, on: filter.states.includes(state), onChange: (on) => toggle(state, on) }),
    )}
    <select
      class="chip"
      aria-label="Type"
      value=${filter.type}
      onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => onChange({ ...filter, type: currentTarget.value })}
    >
      ${TYPES.map(([value, label]) => html`<option key=${value} value=${value}>${label}</option>`)}
    </select>
    <select
      class="chip"
      aria-label="Least inliers"
      value=${String(filter.minInliers)}
      onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) =>
        onChange({ ...filter, minInliers: Number(currentTarget.value) })}
    >
      ${INLIERS.map((count) => html`<option key=${count} value=${String(count)}>Inliers ≥ ${count}</option>`)}
    </select>
  </div>`;
}
