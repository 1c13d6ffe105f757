// What came of a trial: the numbers of both replays side by side, paths, memory and time, and the loops that differ.
import { useEffect, useState } from "preact/hooks";
import { cx, h, html } from "../html.js";
import * as text from "../format.js";
import { go, link } from "../router.js";
import { endTrial, keepTrial, takeOver } from "../trials.js";
import { say, setScene } from "../actions.js";
import { parameters, scene } from "../store.js";
import { Button } from "./button.js";
import { TrialCharts } from "./trial_charts.js";
import { TrialPaths } from "./trial_paths.js";

/** @typedef {import("../types/http").Schemas} Schemas */
/** @typedef {Schemas["TrialComparison"]} Comparison */
/** @typedef {Schemas["TrialSide"]} Side */
/** @typedef {{label: string, hint?: string, of: (side: Side) => number | null | undefined, show?: (value: number | null | undefined) => string, less?: boolean, noise?: number, part?: boolean}} Measure less: is better; part: of the one above; noise: share by which it differs without a reason */

/** @param {number | null | undefined} value */
function ms(value) {
  if (value == null) return text.NONE;
  return Math.abs(value) < 1000 ? `${text.fixed(value, 1)} ms` : `${text.fixed(value / 1000, 2)} s`;
}

/** Times of two runs differ by this much on a machine that does other things as well. */
const NOISE = 0.25;

/** @type {Measure[]} */
const MEASURES = [
  { label: "Nodes", of: ({ nodes }) => nodes },
  { label: "Loops", of: ({ loops_total: total }) => total },
  { part: true, label: "global", hint: "Found by appearance", of: ({ loops }) => loops.GlobalClosure ?? 0 },
  { part: true, label: "proximity", hint: "Found where the path comes near itself", of: ({ loops }) => (loops.LocalSpaceClosure ?? 0) + (loops.LocalTimeClosure ?? 0) },
  { part: true, label: "by hand", of: ({ loops }) => loops.UserClosure ?? 0 },
  { label: "Refused", hint: "Pairs that were tried and are no loop", of: ({ refused }) => refused },
  { label: "ATE", hint: "Trajectory error of the nodes, where truth is known", of: ({ ate_m: ate }) => ate, show: text.length, less: true },
  { label: "Path", hint: "Length of the optimised path", of: ({ path_m: path }) => path, show: text.length },
  { label: "Update, median", hint: "A replay tracks nothing and finds no key points: compare it with the replay, not with the map", of: ({ median_ms: time }) => time, show: ms, less: true, noise: NOISE },
  { label: "Update, 95 %", hint: "Of 100 updates 95 took no longer", of: ({ p95_ms: time }) => time, show: ms, less: true, noise: NOISE },
  { label: "Update, longest", of: ({ max_ms: time }) => time, show: ms, less: true, noise: NOISE },
  { label: "Largest WM", of: ({ wm_max: most }) => most },
  { label: "Largest STM", of: ({ stm_max: most }) => most },
  { label: "LTM at the end", of: ({ ltm_end: count }) => count },
  { label: "Transferred", hint: "Nodes that went to long-term memory, counted each time", of: ({ transferred }) => transferred },
  { label: "Retrieved", hint: "Nodes that came back from there, counted each time", of: ({ retrieved }) => retrieved },
];

/** @param {{map: string, trial: Schemas["Trial"], found: Comparison}} props */
export function TrialResult({ map, trial, found }) {
  return html`<section class="trial" aria-label=${`Trial ${trial.number}`} id="trial-result">
    ${h(Actions, { map, trial })}
    <p class="small quiet">${faithful(found)}${found.images && html` Images were decoded, as ${found.images}.`}</p>
    ${numbers(found)}
    ${h(TrialPaths, { found })}
    ${h(TrialCharts, { found })}
    ${loops("Loops that come", found.came, "They were not there in the replay as it was:")}
    ${loops("Loops that go", found.gone, "They are not there with the changes:")}
  </section>`;
}

/** @param {{map: string, trial: Schemas["Trial"]}} props */
function Actions({ map, trial }) {
  const [naming, setNaming] = useState(/** @type {string | null} */ (null));
  const [waiting, setWaiting] = useState(false);
  const { number, changes } = trial;
  const taken = changes.every(({ name, value }) => parameters.value?.parameters.find((one) => one.name === name)?.value === value);
  const shown = scene.value?.trial === number;
  useEffect(() => () => void (scene.peek()?.trial != null && setScene({ trial: null })), [map, number]);
  const waitFor = async (/** @type {() => Promise<unknown>} */ work) => (setWaiting(true), await work(), setWaiting(false));
  const keep = () =>
    waitFor(async () => {
      const made = await keepTrial(map, number, naming ?? "");
      if (!made) return;
      setNaming(null);
      say(`Kept as ${made.map}: it is in the list of maps`, "good");
    });
  const discard = () =>
    waitFor(async () => {
      if (shown) await setScene({ trial: null });
      await endTrial(map, number, "discard");
      go({ view: "params", query: { tab: "trials" } });
    });
  return html`<div class="form-row trial-actions">
    ${h(Button, { id: "trial-take-over", label: taken ? "Taken over" : "Take over", kind: "accent", hint: taken ? "These values are in force" : "The running engine, or else the next session of this map, has these values", disabled: waiting || taken, onClick: () => void waitFor(() => takeOver(map, trial)) })}
    ${h(Button, { id: "trial-keep", label: "Keep as new map…", hint: "A new map file, with the images of this one", disabled: waiting, pressed: naming !== null, onClick: () => setNaming(naming === null ? `${map.replace(/[^\w.-]+/g, "-")}-trial-${number}` : null) })}
    ${h(Button, { id: "trial-3d", label: "In 3D", hint: "Loops and path of the trial as ghosts in the 3D view", pressed: shown, disabled: waiting, onClick: () => void setScene({ trial: shown ? null : number }) })}
    ${h(Button, { id: "trial-discard", label: "Discard", hint: "Forget this trial", disabled: waiting, onClick: () => void discard() })}
    ${naming !== null &&
    html`<form class="form-row" onSubmit=${(/** @type {Event} */ event) => (event.preventDefault(), void keep())}>
      <input class="field" aria-label="Name of the new map" required pattern="[\\w][\\w.\\-]*" value=${naming} onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => setNaming(currentTarget.value)} />
      <button type="submit" class="button button-accent" disabled=${waiting}>${waiting ? "Writing" : "Keep"}</button>
    </form>`}
  </div>`;
}

/** Whether the replay repeats the run. @param {Comparison} found */
function faithful({ unlike, drift_m: drift }) {
  if (!unlike && drift < 0.001) return "Replayed without changes the map comes out the same, so that what differs here is by the changes.";
  const loops = unlike ? `${text.plural(unlike, "loop")} and poses` : "poses";
  return `Replayed without changes the map differs already from the one that was made, by ${loops} up to ${text.length(drift)}: a replay has stored odometry, other times, and one set of parameters throughout. Compare the two replays.`;
}

/** @param {Comparison} found */
function numbers({ original, baseline, tried }) {
  const shown = MEASURES.filter(({ of }) => [original, baseline, tried].some((side) => of(side)));
  return html`<table class="plain trial-numbers">
    <thead>
      <tr><th></th><th class="right quiet" title="The map as it was made">Map</th><th class="right" title="Replayed with its own parameters">As it was</th><th class="right" title="Replayed with the changes">Tried</th><th class="right">Change</th></tr>
    </thead>
    <tbody>
      ${shown.map((one) => numberRow(one, original, baseline, tried))}
    </tbody>
  </table>`;
}

/** @param {Measure} measure @param {Side} original @param {Side} baseline @param {Side} tried */
function numberRow({ label, hint, of, show = text.whole, less, noise = 0, part }, original, baseline, tried) {
  const [was, before, after] = [original, baseline, tried].map((side) => of(side) ?? null);
  const change = before !== null && after !== null ? after - before : null;
  const differs = change !== null && show(before) !== show(after);
  const noted = differs && Math.abs(Number(change)) > noise * Math.abs(Number(before));
  const tone = !noted ? "quiet" : !less ? "ink-accent strong" : Number(change) < 0 ? "ink-good strong" : "ink-bad strong";
  const sign = Number(change) > 0 ? "+" : "";
  return html`<tr key=${label} class=${cx(noted && "trial-differs")} data-measure=${label}>
    <th scope="row" class=${cx(part && "trial-part")} title=${hint}>${label}</th>
    <td class="right quiet">${show(was)}</td>
    <td class="right">${show(before)}</td>
    <td class="right strong">${show(after)}</td>
    <td class=${cx("right", tone)}>${differs ? `${sign}${show(change)}` : "same"}</td>
  </tr>`;
}

/** @param {string} title @param {Schemas["TrialLoop"][]} found @param {string} why */
function loops(title, found, why) {
  if (!found.length) return html`<p class="small"><b>${title}</b> <span class="quiet">none</span></p>`;
  return html`<details class="fold" open=${found.length <= 12}>
    <summary>${title} <span class="quiet">${found.length}</span></summary>
    <p class="quiet small">${why}</p>
    <table class="plain trial-loops">
      <tbody>
        ${found.map((loop) => html`<tr key=${loop.key}><th scope="row">${loopLink(loop)}</th><td class="quiet">${loop.type}</td><td class="small">${loop.reason || "it was not tried"}</td></tr>`)}
      </tbody>
    </table>
  </details>`;
}

/** A pair that the map knows is in its review; any other can be compared by hand. @param {Schemas["TrialLoop"]} loop */
function loopLink({ key, known }) {
  const [from, to] = key.split("-");
  const href = known ? link({ view: "loops", key }) : link({ view: "loops", query: { tab: "link", from, to } });
  return html`<a href=${href} title=${known ? "Its evidence in this map" : "Compare both nodes"}>${from} → ${to}</a>`;
}
