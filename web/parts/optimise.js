// Optimises the graph on trial: how, every iteration, and what it changes. Nothing of it is stored unless
// somebody keeps its poses.
import { cx, h, html } from "../html.js";
import * as text from "../format.js";
import { moment } from "../router.js";
import { graphRevision, info } from "../store.js";
import { KeepPoses } from "./all_poses.js";
import { Button, Chip } from "./button.js";
import { Facts } from "./facts.js";

/** @typedef {import("../optimising.js").Optimising} Optimising */
/** @typedef {import("../optimising.js").Ask} Ask */
/** @typedef {import("../types/http").Schemas["GraphState"]} GraphState */

const SOLVERS = [["", "as in the map"], ["0", "Levenberg-Marquardt"], ["1", "Gauss-Newton"], ["2", "Dogleg"]];
const KERNELS = [["", "as in the map"], ["none", "none"], ["DCS", "DCS"], ["Cauchy", "Cauchy"], ["GNC", "GNC"]];
const STARTS = [["odometry", "odometry"], ["map", "the map's poses"]];

/** @param {{map: string, trial: Optimising, key?: unknown}} props */
export function Optimise({ trial }) {
  const ask = trial.ask.value;
  const truth = Boolean(info.value?.has_truth);
  return html`<section class="graph-part" aria-label="Optimise">
    <div class="graph-head">
      <h3 class="grow">Optimise on trial</h3>
      ${trial.found.value && h(Button, { label: "Clear", hint: "Take the path out of the 3D view", onClick: () => trial.clear() })}
      ${h(Button, { id: "optimise", label: trial.busy.value ? "Optimising…" : "Optimise", kind: "accent", hint: "A preview: nothing is stored", disabled: trial.busy.value, onClick: () => void trial.run() })}
    </div>
    <div class="graph-form">
      <label>Root <input class="field number" type="number" min="1" placeholder="auto" aria-label="Root node" value=${ask.root ?? ""} onChange=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => trial.change({ root: Number(currentTarget.value) || null })} /></label>
      ${choice("From", STARTS, ask.start, (start) => trial.change({ start: /** @type {"map"} */ (start) }))}
      ${choice("Solver", SOLVERS, ask.solver === null ? "" : String(ask.solver), (solver) => trial.change({ solver: solver === "" ? null : Number(solver) }))}
      ${choice("Kernel", KERNELS, ask.kernel ?? "", (kernel) => trial.change({ kernel: /** @type {"DCS"} */ (kernel) || null }))}
      ${h(Chip, { label: "Align with truth", hint: truth ? "Lay the result over the true path" : "This map has no ground truth", on: ask.align, disabled: !truth, onChange: (align) => trial.change({ align }) })}
    </div>
    ${trial.error.value && html`<p class="ink-bad small" role="alert">${trial.error.value.message}</p>`}
    ${trial.found.value ? h(Result, { trial, found: trial.found.value }) : html`<p class="quiet small">Links that don't count above are left out. The path that comes of it shows dashed beside the map's.</p>`}
    ${h(KeepPoses, { trial })}
  </section>`;
}

/** @param {string} label @param {string[][]} options @param {string} value @param {(value: string) => void} change */
function choice(label, options, value, change) {
  return html`<label>
    ${label}
    <select class="field" aria-label=${label} value=${value} onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => change(currentTarget.value)}>
      ${options.map(([key, name]) => html`<option key=${key} value=${key}>${name}</option>`)}
    </select>
  </label>`;
}

/** @param {{trial: Optimising, found: import("../optimising.js").Optimised}} props */
function Result({ trial, found }) {
  const step = Math.min(trial.step.value, found.steps.length - 1);
  const last = found.steps.length - 1;
  return html`<div class="graph-result">
    <label class="graph-steps">
      <span>${step === 0 ? "Start" : `Iteration ${step}`} <span class="quiet">of ${last}</span></span>
      <input type="range" aria-label="Iteration" min="0" max=${last} value=${step} onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => trial.go(Number(currentTarget.value))} />
    </label>
    <table class="plain" aria-label="Before and after">
      <thead><tr><th></th><th scope="col" class="number">map now</th><th scope="col" class="number">start</th><th scope="col" class="number">${step === last ? "end" : `step ${step}`}</th></tr></thead>
      <tbody>
        ${row("χ²", "Sum of squared, whitened residuals of the links that count", found, step, ({ chi2 }) => chi2, text.short)}
        ${row("ATE", "RMSE against ground truth, aligned", found, step, ({ ate_m }) => ate_m, text.length)}
        ${row("Path", "Length of the path through the nodes that took part", found, step, ({ path_m }) => path_m, text.length)}
      </tbody>
    </table>
    ${h(Facts, { facts: facts(found) })}
    ${found.dropped > 0 && html`<p class="ink-warn small">${text.plural(found.dropped, "node is", "nodes are")} not joined with the root by the links that count, and stay${found.dropped === 1 ? "s" : ""} out.</p>`}
    ${trial.revision !== graphRevision.value && html`<p class="ink-warn small" role="status">The map has changed since: optimise again.</p>`}
    ${moment.value !== null && html`<p class="ink-warn small">The 3D view shows a moment of the past: go to now to see the path.</p>`}
  </div>`;
}

/**
 * @param {string} name @param {string} hint @param {import("../optimising.js").Optimised} found @param {number} step
 * @param {(state: GraphState) => number | null} of @param {(value: number | null) => string} write
 */
function row(name, hint, found, step, of, write) {
  const [now, shown] = [of(found.now), of(found.steps[step])];
  const worse = now !== null && shown !== null && shown > now * 1.001;
  const better = now !== null && shown !== null && shown < now * 0.999;
  return html`<tr title=${hint}>
    <th scope="row">${name}</th>
    <td class="number">${write(now)}</td>
    <td class="number quiet">${write(of(found.steps[0]))}</td>
    <td class=${cx("number", name !== "Path" && worse && "ink-bad", name !== "Path" && better && "ink-good")}>${write(shown)}</td>
  </tr>`;
}

/** @param {import("../optimising.js").Optimised} found @returns {import("./facts.js").Fact[]} */
function facts(found) {
  return [
    ["Poses", text.whole(found.nodes)],
    ["Counted", text.plural(found.links, "link")],
    ["Root", text.whole(found.root)],
    ["Max shift", text.length(found.max_shift_m), "From the map's poses to those of the last iteration"],
    ["Time", `${text.fixed(1000 * found.seconds, 0)} ms`],
    ["Outliers", found.outliers.length ? found.outliers.map(([a, b]) => `${a} → ${b}`).join(", ") : "none", "Loops that the kernel took the weight from"],
    ...(found.fallback ? [/** @type {import("./facts.js").Fact} */ (["Solver", "another took over", "The one asked for found no way down"])] : []),
  ];
}
