// Which loops the queue shows, and in which order.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { RANGES } from "../loop_list.js";
import { weigh, weights } from "../weights.js";
import { Button, Chip } from "./button.js";
import { ORDERS } from "./loop_columns.js";

/** @typedef {import("../loop_list.js").LoopFilterState} LoopFilterState */
/** @typedef {{currentTarget: HTMLSelectElement}} Chosen */

const STATES = /** @type {[string, string][]} */ ([
  ["accepted", "Accepted"],
  ["refused", "Refused"],
  ["approved", "Approved"],
  ["rejected", "Rejected"],
  ["added", "By hand"],
]);
const TYPES = /** @type {[string, string][]} */ ([
  ["", "Type"],
  ["GlobalClosure", "Global"],
  ["LocalSpaceClosure", "Proximity"],
  ["UserClosure", "By hand"],
]);
const INLIERS = [0, 20, 40, 80];

/**
 * @typedef {object} LoopFilterProps
 * @property {LoopFilterState} filter
 * @property {Record<string, number>} counts by state, and of the suspect ones
 * @property {number[]} sessions of the map
 * @property {string} order
 * @property {(filter: LoopFilterState) => void} onChange
 * @property {(order: string) => void} onOrder
 */

/** @param {LoopFilterProps} props */
export function LoopFilter({ filter, counts, sessions, order, onChange, onOrder }) {
  const used = Object.keys(filter.ranges).length + (filter.session === null ? 0 : 1);
  const [open, setOpen] = useState(used > 0);
  const toggle = (/** @type {string} */ state, /** @type {boolean} */ on) => {
    const others = filter.states.filter((one) => one !== state);
    onChange({ ...filter, states: on ? [...others, state] : others });
  };
  return html`<div class="view-tools filters" role="group" aria-label="Filter">
    ${STATES.filter(([state]) => counts[state] || filter.states.includes(state)).map(([state, label]) =>
      h(Chip, { key: state, label: `${label} ${counts[state] ?? 0}`, on: filter.states.includes(state), onChange: (on) => toggle(state, on) }),
    )}
    ${(counts.suspect > 0 || filter.suspect) && h(Chip, { label: `Suspect ${counts.suspect}`, hint: "A doubt of 1 or more, or a look-alike place elsewhere", on: filter.suspect, onChange: (on) => onChange({ ...filter, suspect: on }) })}
    <select class="chip" aria-label="Type" value=${filter.type} onChange=${(/** @type {Chosen} */ { currentTarget }) => onChange({ ...filter, type: currentTarget.value })}>
      ${TYPES.map(([value, label]) => html`<option key=${value} value=${value}>${label}</option>`)}
    </select>
    <select class="chip" aria-label="Least inliers" value=${String(filter.minInliers)} onChange=${(/** @type {Chosen} */ { currentTarget }) => onChange({ ...filter, minInliers: Number(currentTarget.value) })}>
      ${INLIERS.map((count) => html`<option key=${count} value=${String(count)}>${count ? `Inliers ≥ ${count}` : "Inliers"}</option>`)}
    </select>
    ${h(Chip, { label: used ? `More ${used}` : "More", hint: "Filter by any figure, and sort by any", on: open, onChange: setOpen })}
    ${open && more()}
  </div>`;

  function more() {
    const key = order.replace("-", "");
    return html`<div class="filter-more">
      <label>Sort by
        <select class="field" value=${key} onChange=${(/** @type {Chosen} */ { currentTarget }) => onOrder(`-${currentTarget.value}`)}>
          ${ORDERS.map(([value, label]) => html`<option key=${value} value=${value}>${label}</option>`)}
        </select>
      </label>
      <label>Order
        <select class="field" value=${order.startsWith("-") ? "-" : ""} onChange=${(/** @type {Chosen} */ { currentTarget }) => onOrder(currentTarget.value + key)}>
          <option value="-">largest first</option><option value="">smallest first</option>
        </select>
      </label>
      <label>Session
        <select class="field" value=${filter.session === null ? "" : String(filter.session)} disabled=${sessions.length < 2} onChange=${(/** @type {Chosen} */ { currentTarget }) => onChange({ ...filter, session: currentTarget.value === "" ? null : Number(currentTarget.value) })}>
          <option value="">all</option>
          ${sessions.map((one) => html`<option key=${one} value=${String(one)}>${one}</option>`)}
        </select>
      </label>
      ${RANGES.map(({ key: name, label, unit }) => html`<fieldset key=${name}><legend>${label}${unit && html` <span class="quiet">${unit}</span>`}</legend>${bound(name, label, 0)} ${bound(name, label, 1)}</fieldset>`)}
      ${gncButton()}
      ${h(Button, { label: "Clear", disabled: !used, onClick: () => onChange({ ...filter, ranges: {}, session: null }) })}
    </div>`;
  }

  function gncButton() {
    const now = weights.value;
    const running = now?.state === "running";
    const label = running ? "Weighing…" : now?.state === "done" ? "Weigh again" : "Weigh by GNC";
    const hint = now?.state === "failed" ? `GNC failed: ${now.message}` : `Graduated non-convexity over the whole graph, in the background: a weight for each loop, 0 where the rest contradicts it${now?.stale ? ". The map has changed since the last time" : ""}`;
    return html`<div class="filter-gnc">${h(Button, { id: "weigh", label, hint, disabled: running, onClick: () => void weigh() })}${now?.state === "failed" && html`<span class="ink-bad small clip" title=${now.message}>${now.message}</span>`}</div>`;
  }

  /** @param {string} name @param {string} label @param {0 | 1} side */
  function bound(name, label, side) {
    const range = filter.ranges[name] ?? [null, null];
    return html`<input
      class="field"
      type="number"
      step="any"
      aria-label=${`${label}, ${side ? "at most" : "at least"}`}
      placeholder=${side ? "max" : "min"}
      value=${range[side] ?? ""}
      onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => {
        /** @type {[number | null, number | null]} */
        const next = [...range];
        next[side] = currentTarget.value === "" ? null : Number(currentTarget.value);
        const { [name]: _, ...others } = filter.ranges;
        onChange({ ...filter, ranges: next[0] === null && next[1] === null ? others : { ...others, [name]: next } });
      }}
    />`;
  }
}
