// Links by class: whether the 3D view shows them, and whether they count when the graph is optimised on trial.
import { html } from "../html.js";
import { setScene } from "../actions.js";
import * as text from "../format.js";
import { info, scene } from "../store.js";

/** @typedef {import("../types/http").Schemas["Scene"]} Scene */
/** @typedef {NonNullable<Scene["hidden_links"]>[number]} LinkClass */

/** Type of link as it is stored, name, class in the 3D view, colour. @type {[string, string, LinkClass | null, string][]} */
const CLASSES = [
  ["Neighbor", "Neighbour", "neighbor", "ltm"],
  ["NeighborMerged", "Neighbour, merged", "neighbor", "ltm"],
  ["GlobalClosure", "Global loop", "loop", "loop"],
  ["LocalSpaceClosure", "Local in space", "proximity", "near"],
  ["LocalTimeClosure", "Local in time", "time", "time"],
  ["UserClosure", "By hand", "user", "hand"],
  ["VirtualClosure", "Virtual", "virtual", "refused"],
  ["Landmark", "Landmark", "landmark", "truth"],
  ["PosePrior", "Prior", null, "ltm"],
  ["Gravity", "Gravity", null, "ltm"],
];

/** @param {{trial: import("../optimising.js").Optimising}} props */
export function LinkClasses({ trial }) {
  const counts = info.value?.links ?? {};
  const rows = CLASSES.filter(([type]) => counts[type]);
  const hidden = scene.value?.hidden_links ?? [];
  const without = trial.ask.value.without;
  const show = (/** @type {LinkClass} */ kind, /** @type {boolean} */ on) => void setScene({ hidden_links: on ? hidden.filter((one) => one !== kind) : [...hidden, kind] });
  const count = (/** @type {string} */ type, /** @type {boolean} */ on) => trial.change({ without: on ? without.filter((one) => one !== type) : [...without, type] });
  return html`<section class="graph-part" aria-label="Link classes">
    <table class="plain graph-classes">
      <thead>
        <tr><th scope="col">Links</th><th></th><th scope="col" title="In the 3D view">Show</th><th scope="col" title="In the optimisation below; nothing is stored">Count</th></tr>
      </thead>
      <tbody>
        ${rows.map(
          ([type, label, kind, token]) => html`<tr key=${type}>
            <th scope="row"><i class=${`mark mark-line scene-${token}`} aria-hidden="true"></i> ${label}</th>
            <td class="number">${text.whole(counts[type])}</td>
            <td>${kind && box(`Show ${label} links`, !hidden.includes(kind), (on) => show(kind, on), !scene.value)}</td>
            <td>${box(`Count ${label} links`, !without.includes(type), (on) => count(type, on))}</td>
          </tr>`,
        )}
        <tr>
          <th scope="row"><i class="mark mark-dash scene-refused" aria-hidden="true"></i> Refused</th>
          <td></td>
          <td>${box("Show refused loops", !hidden.includes("refused"), (on) => show("refused", on), !scene.value)}</td>
          <td></td>
        </tr>
      </tbody>
    </table>
  </section>`;
}

/** @param {string} label @param {boolean} on @param {(on: boolean) => void} change @param {boolean} [disabled] */
function box(label, on, change, disabled = false) {
  return html`<input
    type="checkbox"
    aria-label=${label}
    checked=${on}
    disabled=${disabled}
    onChange=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => change(currentTarget.checked)}
  />`;
}
