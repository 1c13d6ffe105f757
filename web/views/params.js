// Parameters: those that matter first, the rest by group; each shows the value in force as the engine echoes it.
import { useEffect, useState } from "preact/hooks";
import { h, html } from "../html.js";
import * as text from "../format.js";
import { go, link, openMapId, route } from "../router.js";
import { infoError, loadInfo, loadParameters, parameters } from "../store.js";
import { drafted, gathering, loadTrials, trials } from "../trials.js";
import { DraftBar } from "../parts/draft_bar.js";
import { Parameter } from "../parts/parameter.js";
import { Chip } from "../parts/button.js";
import { Empty, Failed, Loading } from "../parts/state.js";
import { Trials } from "../parts/trials.js";

/** @typedef {import("../store.js").Schemas["Parameter"]} ParameterEntry */

export function Params() {
  const onTrials = route.value.query.get("tab") === "trials";
  useEffect(() => (void loadParameters(), void loadTrials()), [openMapId.value]);
  return html`<div class="view">
    <div class="view-head">
      <h2>Parameters</h2>
      <span class="grow"></span>
      <nav class="tabs" aria-label="Parameters">
        <a href=${link({ view: "params" })} aria-current=${onTrials ? undefined : "true"}>Values</a>
        <a href=${link({ view: "params", query: { tab: "trials" } })} aria-current=${onTrials ? "true" : undefined}>
          Trials${trials.value?.length ? ` ${trials.value.length}` : ""}
        </a>
      </nav>
    </div>
    ${onTrials ? h(Trials, { map: /** @type {string} */ (openMapId.value), chosen: Number(route.value.key) || null }) : h(Values, {})}
  </div>`;
}

function Values() {
  const query = route.value.query.get("q") ?? "";
  const [changedOnly, setChangedOnly] = useState(false);
  const [set, error] = [parameters.value, infoError.value];
  const search = (/** @type {string} */ q) => go({ view: "params", query: q ? { q } : {} }, { replace: true });
  const gathered = set !== null && (!set.live || gathering.value);
  return html`
    <div class="view-tools">
      ${set?.live && h(Chip, { label: "Draft", hint: "Gather changes, and try them on the map before they are applied; otherwise each applies at once", on: gathering.value, onChange: gather })}
      ${h(Chip, { label: "Changed", hint: "Only those that differ from their default", on: changedOnly, onChange: setChangedOnly })}
      <input
        type="search"
        class="field grow"
        placeholder="Name or meaning"
        aria-label="Find parameters by name or meaning"
        value=${query}
        onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => search(currentTarget.value)}
      />
    </div>
    ${set && gathered && h(DraftBar, { set })}
    ${set && !set.live && !Object.keys(drafted.value).length && html`<p class="note note-quiet" id="params-locked">${noEngine}</p>`}
    <div class="view-body">${set ? groups(set, query, changedOnly, gathered) : error ? h(Failed, { error, what: "The parameters didn't arrive.", onRetry: () => void Promise.all([loadInfo(), loadParameters()]) }) : h(Loading, {})}</div>
  `;
}

/** @param {boolean} on */
function gather(on) {
  gathering.value = on;
  if (!on) drafted.value = {};
}

const noEngine =
  "No engine runs on this map: these are its values. Change some to try them on this map, or to have its next session start with them.";

/** @param {import("../store.js").Schemas["ParameterSet"]} set @param {string} query @param {boolean} changedOnly @param {boolean} gathered */
function groups(set, query, changedOnly, gathered) {
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
    ${front.length > 0 && html`<section>${front.map((one) => row(one, set.live, gathered))}</section>`}
    ${[...rest].map(
      ([group, entries]) => html`<details class="fold" key=${`${group}-${searching}`} open=${searching}>
        <summary>${group} <span class="quiet">${text.whole(entries.length)}</span></summary>
        ${entries.map((one) => row(one, set.live, gathered))}
      </details>`,
    )}
    ${Object.keys(set.unused).length > 0 && h(Unused, { unused: set.unused })}
  </div>`;
}

/** @param {ParameterEntry} entry @param {boolean} live @param {boolean} gathered */
function row(entry, live, gathered) {
  return h(Parameter, { key: entry.name, entry, live, gathered });
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
