// The maps under the data root, and where a new run starts.
import { useState } from "preact/hooks";
import { cx, h, html } from "../html.js";
import { address } from "../api.js";
import * as text from "../format.js";
import { link, openMapId } from "../router.js";
import { loadMaps, maps, mapsError, session } from "../store.js";
import { Button } from "../parts/button.js";
import { About } from "../parts/about.js";
import { Badge } from "../parts/facts.js";
import { NewRun } from "../parts/new_run.js";
import { Empty, Failed, Loading } from "../parts/state.js";

/** @typedef {import("../store.js").Schemas["MapSummary"]} MapSummary */

export function Maps() {
  const [query, setQuery] = useState("");
  const [starting, setStarting] = useState(false);
  const found = maps.value?.filter(({ id }) => id.toLowerCase().includes(query.toLowerCase()));
  const busy = ["starting", "running", "paused"].includes(session.value?.state ?? "idle");
  return html`<div class="view">
    <div class="view-head">
      <h2>Maps</h2>
      <span class="quiet grow">${maps.value ? text.plural(maps.value.length, "file") : ""}</span>
      ${h(Button, {
        id: "new-run",
        icon: "plus",
        label: "New run",
        hint: busy ? "Stop the run under way first" : "Make a map out of a sequence",
        disabled: busy,
        onClick: () => setStarting(!starting),
      })}
    </div>
    ${starting && h(NewRun, { close: () => setStarting(false) })}
    ${(maps.value?.length ?? 0) > 5 &&
    html`<div class="view-tools">
      <input
        type="search"
        class="field grow"
        placeholder="Find a map"
        aria-label="Find a map"
        value=${query}
        onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => setQuery(currentTarget.value)}
      />
    </div>`}
    <div class="view-body">${mapsError.value && !maps.value ? failed() : list(found)}</div>
  </div>`;
}

function failed() {
  const error = /** @type {Error} */ (mapsError.value);
  return h(Failed, { error, what: "The list of maps didn't arrive.", onRetry: () => void loadMaps() });
}

/** @param {MapSummary[] | undefined} found */
function list(found) {
  if (!found) return h(Loading, {});
  if (!found.length && maps.value?.length) return h(Empty, { icon: "search", title: "No map is called that", children: "Try part of its name." });
  if (!found.length) {
    const how = html`<p>Start a run above, or put <code>.db</code> files of slamdeck or RTAB-Map into the served folder. On the command line:</p>
      <code>slamdeck run FOLDER --db map.db</code>`;
    return h(Empty, { icon: "maps", title: "There are no maps yet", children: how });
  }
  return html`${openMapId.value && h(About, { map: openMapId.value })}<ul class="cards">
    ${found.map((map) => html`<li key=${map.id}>${h(Card, { map })}</li>`)}
  </ul>`;
}

/** @param {{map: MapSummary}} props */
function Card({ map }) {
  const open = map.id === openMapId.value;
  return html`<a
    class=${cx("card", map.error && "card-broken")}
    href=${map.error ? undefined : link({ map: map.id, view: "loops" })}
    aria-current=${open ? "true" : undefined}
    aria-disabled=${map.error ? "true" : undefined}
  >
    ${h(Preview, { map })}
    <div class="grow">
      <div class="card-title">
        <b class="clip">${map.name}</b>
        ${map.live && h(Badge, { tone: "good", children: "live" })} ${open && h(Badge, { tone: "accent", children: "open" })}
      </div>
      ${map.error ? html`<p class="ink-bad small">${map.error}</p>` : h(CardFacts, { map })}
    </div>
  </a>`;
}

/** @param {{map: MapSummary}} props */
function Preview({ map }) {
  const [missing, setMissing] = useState(false);
  if (missing || map.error || !map.nodes) return html`<div class="card-image card-noimage" aria-hidden="true"></div>`;
  const source = address("api", "maps", map.id, "preview.jpg");
  return html`<img class="card-image" src=${source} alt="" loading="lazy" onError=${() => setMissing(true)} />`;
}

/** @param {{map: MapSummary}} props */
function CardFacts({ map }) {
  return html`<p class="card-facts">
      <span><b>${text.whole(map.nodes)}</b> nodes</span>
      <span><b>${text.whole(map.loops)}</b> loops</span>
      <span><b>${text.whole(Object.values(map.links).reduce((sum, count) => sum + count, 0))}</b> links</span>
      ${map.sessions > 1 && html`<span><b>${map.sessions}</b> sessions</span>`}
    </p>
    <p class="quiet small">${text.size(map.size_bytes)} · ${text.ago(map.modified)} · format ${map.version}</p>`;
}
