// Long work on the map: more loops, better links; how far it is, what it says, and taking it back.
import { useEffect, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { author, decide, deciding, told } from "../actions.js";
import { get, post } from "../api.js";
import { on } from "../events.js";
import * as text from "../format.js";
import { go, link, route } from "../router.js";
import { Author } from "./author.js";
import { Button, Chip } from "./button.js";
import { Covariances } from "./covariances.js";
import { effectParts, isMade, stopReason } from "./decision_bar.js";
import { CheckField, GUESSES, METHODS, NumberField, numbers, SelectField, Sessions } from "./inputs.js";
import { changesOf, REGRID, RegridForm } from "./regrid.js";
import { useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["Job"]} Job */
/** @typedef {import("../store.js").Schemas["StartJob"]} StartJob */

const DETECT = { radius_m: "1", min_radius_m: "0", angle_deg: "30", iterations: "5", min_graph_distance: "10", method: "visual", guess: "none", intra: true, inter: true, session: "" };
const REFINE = { type: "", first: "0", last: "0", method: "visual", covariance_only: false, intra: true, inter: true, session: "" };
/** @type {[string, string][]} */
const TYPES = [["", "all types"], ["Neighbor", "neighbours"], ["GlobalClosure", "global loops"], ["LocalSpaceClosure", "proximity"], ["LocalTimeClosure", "in time"], ["UserClosure", "by hand"], ["NeighborMerged", "bridges"]];

/** @type {["detect" | "refine" | "regrid" | "covariances", string][]} */
const KINDS = [["detect", "Detect more loops"], ["refine", "Refine links"], ["regrid", "Make local grids"], ["covariances", "Type covariances"]];

/** @param {{map: string}} props */
export function Jobs({ map }) {
  const { data } = useFetched((signal) => get("/api/maps/{map}/job", { path: { map }, signal }), [map]);
  const [heard, setHeard] = useState(/** @type {Job | null} */ (null));
  useEffect(() => on("job", (value, of) => of === map && setHeard(value)), [map]);
  const query = route.value.query;
  const kind = KINDS.find(([name]) => name === query.get("work"))?.[0] ?? "detect";
  const [detect, setDetect] = useState(DETECT);
  const [refine, setRefine] = useState(REFINE);
  const [regrid, setRegrid] = useState({ ...REGRID, first: query.get("first") ?? "0", last: query.get("last") ?? "0" });
  const job = heard ?? data.value?.job ?? null;
  const locked = stopReason();
  const running = job?.state === "running";
  const start = async () => {
    const body = kind === "detect" ? { detect: numbers(detect) } : kind === "refine" ? refineBody(refine) : regridBody(regrid);
    const begun = await told(post("/api/maps/{map}/job", { path: { map }, body: /** @type {StartJob} */ ({ ...body, author: author.value.trim() }) }));
    // The stream may have told of its end already.
    if (begun) setHeard((last) => (last?.id === begun.id ? last : begun));
  };
  const cancel = async () => void (await told(post("/api/maps/{map}/job/cancel", { path: { map }, body: undefined })));
  return html`<div class="view-part jobs">
    <div class="form-row" role="group" aria-label="What to do">
      ${KINDS.map(([name, label]) => h(Chip, { key: name, label, on: kind === name, onChange: () => go({ view: "loops", query: { tab: "jobs", ...(name !== "detect" && { work: name }) } }, { replace: true }) }))}
    </div>
    ${kind === "covariances" && h(Covariances, {})} ${kind === "detect" && h(DetectForm, { wanted: detect, onChange: setDetect })}
    ${kind === "refine" && h(RefineForm, { wanted: refine, onChange: setRefine })} ${kind === "regrid" && h(RegridForm, { map, wanted: regrid, onChange: setRegrid })}
    ${kind !== "covariances" && isMade() && html`<p class="note" id="jobs-held">${locked}.</p>`}
    ${kind !== "covariances" &&
    html`<div class="form-row">
      ${h(Author, {})}<span class="grow"></span>
      ${h(Button, { id: "job-start", label: "Start", kind: "accent", hint: locked ?? "What it finds is one batch: one undo takes all of it back", disabled: running || !!locked, onClick: () => void start() })}
    </div>`}
    ${job && h(JobPanel, { map, job, onCancel: cancel })}
  </div>`;
}

/** @param {typeof REFINE} wanted */
function refineBody({ type, ...rest }) {
  return { refine: { ...numbers(rest), types: type ? [type] : [] } };
}

/** @param {import("./regrid.js").Wanted} wanted */
function regridBody({ changes, ...rest }) {
  return { regrid: { ...numbers(rest), changes: changesOf({ ...rest, changes }) } };
}

/** @param {{wanted: typeof DETECT, onChange: (wanted: typeof DETECT) => void}} props */
function DetectForm({ wanted, onChange }) {
  const set = (/** @type {Partial<typeof DETECT>} */ change) => onChange({ ...wanted, ...change });
  return html`<div class="form-row">
    ${h(NumberField, { label: "Radius (m)", value: wanted.radius_m, hint: "Largest distance of two nodes", onChange: (radius_m) => set({ radius_m }) })}
    ${h(NumberField, { label: "at least (m)", value: wanted.min_radius_m, hint: "Smallest distance of two nodes", onChange: (min_radius_m) => set({ min_radius_m }) })}
    ${h(NumberField, { label: "Angle (°)", value: wanted.angle_deg, hint: "Largest angle between where they look", onChange: (angle_deg) => set({ angle_deg }) })}
    ${h(NumberField, { label: "Rounds", value: wanted.iterations, step: "1", hint: "Each with the poses of the last", onChange: (iterations) => set({ iterations }) })}
    ${h(NumberField, { label: "Links apart", value: wanted.min_graph_distance, step: "1", hint: "Fewest links between two nodes of a session", onChange: (min_graph_distance) => set({ min_graph_distance }) })}
    ${h(SelectField, { label: "by", value: wanted.method, options: METHODS, onChange: (method) => set({ method }) })}
    ${h(SelectField, { label: "from", value: wanted.guess, options: GUESSES, onChange: (guess) => set({ guess }) })}
    ${h(Sessions, { wanted, onChange: set })}
  </div>`;
}

/** @param {{wanted: typeof REFINE, onChange: (wanted: typeof REFINE) => void}} props */
function RefineForm({ wanted, onChange }) {
  const set = (/** @type {Partial<typeof REFINE>} */ change) => onChange({ ...wanted, ...change });
  return html`<div class="form-row">
    ${h(SelectField, { label: "Links", value: wanted.type, options: TYPES, onChange: (type) => set({ type }) })}
    ${h(NumberField, { label: "from node", value: wanted.first, step: "1", onChange: (first) => set({ first }) })}
    ${h(NumberField, { label: "to node", value: wanted.last, step: "1", hint: "0: to the last", onChange: (last) => set({ last }) })}
    ${h(SelectField, { label: "by", value: wanted.method, options: METHODS, onChange: (method) => set({ method }) })}
    ${h(CheckField, { label: "covariances alone", on: wanted.covariance_only, onChange: (covariance_only) => set({ covariance_only }) })}
    ${h(Sessions, { wanted, onChange: set })}
  </div>`;
}

/**
 * Whether a job's batch was undone since, here or in another window, and whether it is what an undo would take back now.
 * @param {string} map
 * @param {number | null} entry the batch's first, null while there is none
 * @returns {{undone: boolean, last: boolean}}
 */
function useBatch(map, entry) {
  const { data, reload } = useFetched((signal) => (entry === null ? null : get("/api/maps/{map}/decisions", { path: { map }, signal })), [map, entry]);
  useEffect(() => on("decision", (_, of) => of === map && reload()), [map]);
  const entries = data.value?.entries ?? [];
  const undone = Boolean(entries.find(({ id }) => id === entry)?.undone_by);
  const since = entries.some(({ id, batch, action, undone_by: by }) => id > Number(entry) && batch !== entry && !by && action !== "undo" && action !== "redo");
  return { undone, last: entries.length > 0 && !undone && !since };
}

/** @param {Job["kind"]} kind @param {NonNullable<Job["decision"]>} decision */
function doneText(kind, { count, entry }) {
  if (kind === "regrid") return `Local grids of ${entry.note}`;
  return `${text.plural(count, "link")} ${kind === "detect" ? "added" : "refined"}`;
}

/** @type {Record<Job["kind"], string>} */
const WORK = { detect: "Detecting loops", refine: "Refining links", regrid: "Making local grids" };
/** @type {Record<Job["state"], string>} */
const STATES = { running: "at work", done: "done", cancelled: "cancelled, the map is as it was", failed: "failed" };

/** @param {{map: string, job: Job, onCancel: () => Promise<void>}} props */
function JobPanel({ map, job, onCancel }) {
  const { state, share, log, message, decision } = job;
  const { undone, last } = useBatch(map, decision?.entry.id ?? null);
  const [leaving, setLeaving] = useState(0);
  const cancel = async () => {
    setLeaving(job.id);
    await onCancel();
    setLeaving(0);
  };
  // The process that works on a map starts with its first job.
  const told = message || (log.at(-1) ?? (state === "running" ? "Reading the map…" : ""));
  return html`<section class="job" aria-label="Job" id="job">
    <div class="form-row">
      <b>${WORK[job.kind]}: ${undone ? "done, and taken back" : STATES[state]}</b>
      <span class="quiet grow clip small" title=${told}>${told}</span>
      ${state === "running" && h(Button, { id: "job-cancel", label: leaving === job.id ? "Cancelling…" : "Cancel", hint: "The map stays as it was before", disabled: leaving === job.id, onClick: () => void cancel() })}
      ${decision && !undone && job.kind === "detect" && html`<a class="button" id="job-review" href=${link({ view: "loops", key: null, query: { state: "added" } })} title="The loops that were found, in the queue">Review</a>`}
      ${decision && !undone && h(Button, { id: "job-undo", label: "Undo", hint: last ? "Take all of this batch back" : "Something was decided since; the journal takes back one after the other", disabled: deciding.value || !last, onClick: () => void decide({ action: "undo" }) })}
    </div>
    <progress max="1" value=${share} aria-label="Done">${text.fixed(100 * share, 0)} %</progress>
    ${decision && html`<p class="small">${doneText(job.kind, decision)}${undone ? ", all taken back since" : ""}: ${effectParts(decision.effect)}</p>`}
    ${log.length > 0 && html`<details class="fold"><summary>Log <span class="quiet">${text.whole(log.length)}</span></summary><pre class="job-log small">${log.join("\n")}</pre></details>`}
  </section>`;
}
