// Parameters: those that matter first, the rest by group; each shows the value in force as the engine echoes it.
import { useEffect, useState } from "preact/hooks";
import { h, html } from "../html.js";
import * as text from "../format.js";
import { go, route } from "../router.js";
import { loadParameters, parameters } from "../store.js";
import { Parameter } from "../parts/parameter.js";
import { Chip } from "../parts/button.js";
import { Empty, Loading } from "../parts/state.js";

/** @typedef {import("../store.js").Schemas["Parameter"]} ParameterEntry */

export function Params() {
  const query = route.value.query.get("q") ?? "";
  const [changedOnly, setChangedOnly] = useState(false);
  const set = parameters.value;
  useEffect(() => void loadParameters(), []);
  const search = (/** @type {string} */ q) => go({ view: "params", query: q ? { q } : {} }, { replace: true });
  return html`<div class="view">
    <div class="view-head">
      <h2>Parameters</h2>
      <span class="grow"></span>
      ${h(Chip, { label: "Changed", hint: "Only those that differ from their default", on: changedOnly, onChange: setChangedOnly })}
      <input
        type="search"
        class="field"
        placeholder="Name or meaning"
        aria-label="Find parameters by name or meaning"
        value=${query}
        onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => search(currentTarget.value)}
      />
    </div>
    ${set && !set.live && html`<p class="note" id="params-locked">${lockedReason}</p>`}
    <div class="view-body">${set ? groups(set, query, changedOnly) : h(Loading, {})}</div>
  </div>`;
}

const lockedReason =
  "No engine runs on this map, so these are the values it was made with. Start a run (Maps) to change them while it maps.";

/** @param {import("../store.js").Schemas["ParameterSet"]} set @param {string} query @param {boolean} changedOnly */
function groups(set, query, changedOnly) {
  const wanted = query.toLowerCase();
  const found = set.parameters.filter(
    ({ name, meaning, value, default: usual }) =>
      `${name} ${meaning}`.toLowerCase().includes(wanted) && (!changedOnly || value !== usual),
  );
  if (!found.length) return h(Empty, { icon: "search", title: "No parameter fits", children: "Names are RTAB-Map's, for example Rtabmap/LoopThr." });
  const front = found.filter((one) => one.front);
  const rest = Map.groupBy(found.filter((one) => !one.front), (one) => one.group);
  const searching = Boolean(wanted) || changedOnly;
  return html`<div class="params">
    ${front.length > 0 && html`<section>${front.map((one) => row(one, set.live))}</section>`}
    ${[...rest].map(
      ([group, entries]) => html`<details class="fold" key=${`${group}-${searching}`} open=${searching}>
        <summary>${group} <span class="quiet">${text.whole(entries.length)}</span></summary>
        ${entries.map((one) => row(one, set.live))}
      </details>`,
    )}
    ${Object.keys(set.unused).length > 0 && h(Unused, { unused: set.unused })}
  </div>`;
}

/** @param {ParameterEntry} entry @param {boolean} live */
function row(entry, live) {
  return h(Parameter, { key: entry.name, entry, live });
}

/** @param {{unused: Record<string, string>}} props */
function Unused({ unused }) {
  return html`<details class="fold">
    <summary>Kept, but not used here <span class="quiet">${Object.keys(unused).length}</span></summary>
    <p class="quiet small">RTAB-Map knows these; slamdeck keeps them in the file and doesn't read them.</p>
    <table class="plain">
      <tbody>
        ${Object.entries(unused).map(
          ([name, value]) => html`<tr key=${name}><th scope="row">${name}</th><td class="right clip">${value}</td></tr>`,
        )}
      </tbody>
    </table>
  </details>`;
}
