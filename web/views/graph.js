// The graph as a whole: which links show and count, other optimisations of it, its sessions and components.
import { h, html } from "../html.js";
import * as text from "../format.js";
import { openMapId } from "../router.js";
import { info } from "../store.js";
import { LinkClasses } from "../parts/link_classes.js";
import { Optimise } from "../parts/optimise.js";
import { TurnMap } from "../parts/all_poses.js";
import { Pieces } from "../parts/pieces.js";
import { SessionToggles } from "../parts/session_toggles.js";
import { optimisingOf } from "../optimising.js";

export function GraphView() {
  const map = /** @type {string} */ (openMapId.value);
  const links = Object.values(info.value?.links ?? {}).reduce((sum, count) => sum + count, 0);
  return html`<div class="view">
    <div class="view-head">
      <h2>Graph</h2>
      <span class="quiet grow">${info.value ? `${text.plural(info.value.nodes, "node")}, ${text.plural(links, "link")}` : ""}</span>
    </div>
    <div class="view-body graph-view">
      ${h(LinkClasses, { trial: optimisingOf(map) })} ${h(Optimise, { key: map, map, trial: optimisingOf(map) })} ${h(TurnMap, { key: `turn ${map}` })}
      ${h(SessionToggles, {})}
      ${h(Pieces, { key: `pieces ${map}`, map })}
    </div>
  </div>`;
}
