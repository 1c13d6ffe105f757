// The trials of a map: what was tried, how far it is, and what came of the one that is chosen.
import { useEffect } from "preact/hooks";
import { cx, h, html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { go, link } from "../router.js";
import { endTrial, loadTrials, trials, trialsError } from "../trials.js";
import { Badge } from "./facts.js";
import { Button } from "./button.js";
import { valueText } from "./parameter.js";
import { Empty, Failed, Loading } from "./state.js";
import { TrialResult } from "./trial.js";
import { useFetched } from "./use.js";

/** @typedef {import("../trials.js").Trial} Trial */

/** @param {{map: string, chosen: number | null}} props */
export function Trials({ map, chosen }) {
  const all = trials.value;
  useEffect(() => void loadTrials(), [map]);
  if (!all) return trialsError.value ? h(Failed, { error: trialsError.value, what: "The trials didn't arrive.", onRetry: () => void loadTrials() }) : h(Loading, {});
  if (!all.length) return h(NoTrials, {});
  const shown = all.find(({ number }) => number === chosen);
  return html`<div class="view-body trials">
    <ul class="trial-list" aria-label="Trials">${all.map((one) => row(map, one, one === shown))}</ul>
    ${shown?.state === "done" && h(Outcome, { key: shown.number, map, trial: shown })}
    ${shown?.state === "failed" && h(FailedTrial, { map, trial: shown })}
    ${!shown && html`<p class="quiet trial-hint">Choose a trial to see both runs side by side.</p>`}
  </div>`;
}

function NoTrials() {
  return h(Empty, {
    icon: "params",
    title: "Nothing was tried on this map yet",
    children: html`Change values of parameters, and <b>Try on this map</b>: its nodes are replayed with them, and both runs are compared here.${" "}
      <a href=${link({ view: "params" })}>Change values</a>`,
  });
}

/** @param {string} map @param {Trial} trial @param {boolean} chosen */
function row(map, trial, chosen) {
  const { number, state, share, stale, started } = trial;
  return html`<li key=${number} class=${cx("trial-row", chosen && "trial-chosen")} data-trial=${number}>
    <a class="trial-name" href=${link({ view: "params", key: number, query: { tab: "trials" } })} aria-current=${chosen ? "true" : undefined}>
      <b>${number}</b> ${changesText(trial)}
    </a>
    ${state === "failed" && h(Badge, { tone: "bad", children: "failed" })}
    ${stale && h(Badge, { tone: "warn", hint: "The map or its parameters have changed since: this is what came of it as it was then", children: "older map" })}
    ${state !== "running" && html`<span class="quiet small">${text.ago(started)}</span>`}
    ${state === "running" &&
    html`<span class="trial-progress small" role="status">
      <progress max="1" value=${share} aria-label="Done">${text.fixed(100 * share, 0)} %</progress>
      <span class="quiet">${trial.text}</span>
      ${h(Button, { id: "trial-cancel", label: "Cancel", hint: "Stop it; nothing of it stays", onClick: () => void endTrial(map, number, "cancel") })}
    </span>`}
  </li>`;
}

/** @param {Trial} trial */
export function changesText({ changes }) {
  return changes.map(({ name, before, value }) => `${name} ${valueText(before)} → ${valueText(value)}`).join(", ");
}

/** @param {{map: string, trial: Trial, key?: unknown}} props */
function Outcome({ map, trial }) {
  const { number } = trial;
  const { data, error, reload } = useFetched((signal) => get("/api/maps/{map}/trials/{number}", { path: { map, number }, signal }), [map, number, trial.state]);
  if (error.value) return h(Failed, { error: error.value, what: "The outcome didn't arrive.", onRetry: reload });
  if (!data.value?.comparison) return h(Loading, {});
  return h(TrialResult, { map, trial, found: data.value.comparison });
}

/** @param {{map: string, trial: Trial}} props */
function FailedTrial({ map, trial }) {
  const discard = async () => (await endTrial(map, trial.number, "discard"), go({ view: "params", query: { tab: "trials" } }));
  return html`<div class="empty failed" role="alert">
    <strong>This trial could not be carried out</strong>
    <div class="quiet">${trial.text}</div>
    ${h(Button, { label: "Discard", onClick: () => void discard() })}
  </div>`;
}
