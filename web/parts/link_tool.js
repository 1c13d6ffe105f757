// A link by hand: two nodes, how they are matched, what it would do, and then done.
import { useEffect, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { deciding, editLink, told } from "../actions.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { go, link as linkTo, route } from "../router.js";
import { graphRevision } from "../store.js";
import { Author } from "./author.js";
import { Button, Chip } from "./button.js";
import { effectParts, lockReason } from "./decision_bar.js";
import { Facts } from "./facts.js";
import { CheckField, GUESSES, METHODS, NumberField, SelectField } from "./inputs.js";
import { PointPairs } from "./point_pairs.js";
import { rollPitchYaw, rotationText, translationText } from "./pose.js";
import { Failed } from "./state.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["LinkEditResult"]} Result */
/** @typedef {import("../store.js").Schemas["LinkEdit"]} Edit */
/** @typedef {import("./point_pairs.js").Picked} Picked */
/** @typedef {"add" | "points" | "edit" | "refine" | "reset"} Action */

const AXES = ["x (m)", "y (m)", "z (m)", "roll (°)", "pitch (°)", "yaw (°)"];
const SIGMAS = ["0.05", "0.05", "0.05", "1", "1", "1"];
const ZEROS = ["0", "0", "0", "0", "0", "0"];
/** @type {[Action, string, string][]} */
const NEW = [
  ["add", "Match", "Register both nodes by their images or clouds"],
  ["points", "Points", "Pick the same points in both images or clouds"],
  ["edit", "Type", "Enter the transform"],
];
/** @type {[Action, string, string][]} */
const KNOWN = [
  ["refine", "Refine", "Register both nodes again, from what the link says"],
  ["edit", "Type", "Change its numbers"],
  ["reset", "Reset", "As it was before anybody edited it"],
];

/** Nodes clicked in the 3D view go into the tool; the one that was there longer leaves. @param {number} id */
export function pickEnd(id) {
  const { query } = route.value;
  if (String(id) !== query.get("to")) setEnds(query.get("to") ?? "", String(id));
}

/** @param {string} from @param {string} to */
function setEnds(from, to) {
  go({ view: "loops", query: { tab: "link", ...(from && { from }), ...(to && { to }) } }, { replace: true });
}

/** @param {{map: string, onDone: () => void}} props */
export function LinkTool({ map, onDone }) {
  const { query } = route.value;
  const [from, to] = [query.get("from") ?? "", query.get("to") ?? ""];
  const whole = Number(from) > 0 && Number(to) > 0 && from !== to;
  return html`<div class="view-part link-tool">
    <div class="form-row">
      ${h(NumberField, { label: "Node", value: from, step: "1", onChange: (value) => setEnds(value, to) })}
      ${h(NumberField, { label: "and node", value: to, step: "1", onChange: (value) => setEnds(from, value) })}
      <span class="quiet small grow">or click two nodes in the 3D view</span>
    </div>
    ${whole
      ? h(Ends, { key: `${from}-${to}`, map, from: Number(from), to: Number(to), onDone })
      : html`<p class="quiet pad">Name two nodes to link them, or to refine, change or reset the link that they have.</p>`}
  </div>`;
}

/** @param {{map: string, from: number, to: number, onDone: () => void, key?: unknown}} props */
function Ends({ map, from, to, onDone }) {
  const { data, error, reload } = useFetched(
    (signal) => get("/api/maps/{map}/links/{from_id}/{to_id}/known", { path: { map, from_id: from, to_id: to }, signal }),
    [map, from, to],
  );
  useChanged(graphRevision, reload, 300);
  if (error.value) return h(Failed, { error: error.value, what: "These nodes can't be looked at.", onRetry: reload });
  if (!data.value) return html`<p class="quiet pad">Looking at both nodes…</p>`;
  // A pair that was looked at and is not in the graph has no residual.
  const { link } = data.value;
  const known = link !== null && link.residual_sigma !== null ? link : null;
  return h(Form, { key: known ? "known" : "new", map, from, to, known, note: data.value.note, onDone: () => (reload(), onDone()) });
}

/** @param {{map: string, from: number, to: number, known: import("./link.js").LinkDetail | null, note: string, onDone: () => void, key?: unknown}} props note: why nothing is known of them */
function Form({ map, from, to, known, note, onDone }) {
  const kinds = known ? KNOWN : NEW;
  const [action, setAction] = useState(kinds[0][0]);
  const [method, setMethod] = useState("visual");
  const [guess, setGuess] = useState("graph");
  const [points, setPoints] = useState(/** @type {Picked[]} */ ([]));
  const [typed, setTyped] = useState(() => start(known, from));
  const [force, setForce] = useState(false);
  const [seen, setSeen] = useState(/** @type {Result | null} */ (null));
  const [failed, setFailed] = useState("");
  const [busy, setBusy] = useState(false);
  useEffect(() => (setSeen(null), setFailed(""), setForce(false)), [action, method, guess, points, typed]);
  // Where no link says better, numbers are typed from where the map has both nodes.
  useEffect(() => {
    if (action !== "edit" || typed.transform !== ZEROS) return;
    void told(get("/api/maps/{map}/nodes/{node_id}/pair/{other_id}", { path: { map, node_id: from, other_id: to } })).then(
      (pair) => pair?.map && setTyped((last) => (last.transform === ZEROS ? { ...last, transform: fields(pair.map?.transform ?? []) } : last)),
    );
  }, [action]);
  const locked = lockReason();
  const pairs = points.flatMap(({ left, right }) => (right ? [{ from: left, to: right }] : []));
  const ready = action !== "points" || pairs.length > 2;

  const ask = async (/** @type {boolean} */ preview) => {
    setBusy(true);
    const body = /** @type {Edit} */ ({ action, from, to, method, guess, force, preview, author: "", pairs });
    if (action === "edit") Object.assign(body, { transform: typed.transform.map(Number), sigmas: typed.sigmas.map(Number) });
    const answer = await editLink(body);
    setBusy(false);
    if ("error" in answer) return setFailed(answer.error);
    setFailed("");
    setSeen(answer);
    if (!preview) onDone();
  };

  return html`<div class="link-form">
    <p class="small">
      ${known
        ? html`Nodes ${from} and ${to} are joined by a <a href=${linkTo({ view: "loops", key: `${known.from}-${known.to}` })}>link of type ${known.type}</a>.`
        : note ? html`${note[0].toUpperCase()}${note.slice(1)}.` : html`Nodes ${from} and ${to} are not linked.`}
    </p>
    <div class="form-row" role="group" aria-label="How">
      ${kinds.map(([kind, label, hint]) => h(Chip, { key: kind, label, hint, on: kind === action, onChange: () => setAction(kind) }))}
      ${(action === "add" || action === "refine") && h(SelectField, { label: "by", value: method, options: METHODS, onChange: setMethod })}
      ${action === "add" && h(SelectField, { label: "from", value: guess, options: GUESSES, onChange: setGuess })}
    </div>
    ${action === "points" && h(PointPairs, { map, from, to, points, residuals: seen?.residuals_m ?? null, onChange: setPoints })}
    ${action === "edit" && h(Numbers, { from, to, typed, onChange: setTyped })}
    ${failed && html`<p class="note" role="alert">${failed}</p>`}
    ${seen && h(Outcome, { seen, done: seen.decision !== null && !seen.decision.preview })}
    <div class="form-row">
      ${h(Author, {})}<span class="grow"></span>
      ${seen?.reason && seen.link && h(CheckField, { label: "all the same", hint: "Although the test above speaks against it", on: force, onChange: setForce })}
      ${h(Button, { id: "link-preview", label: busy ? "Working…" : "Preview", hint: locked ?? "What it would do; nothing is changed", disabled: busy || !ready || !!locked, onClick: () => void ask(true) })}
      ${h(Button, {
        id: "link-accept",
        label: action === "reset" ? "Reset" : known ? "Change" : "Add",
        kind: "good",
        hint: locked ?? (seen ? "Write it into the map; undo takes it back" : "Preview it first"),
        disabled: busy || !seen?.link || !seen.decision?.preview || (seen.reason !== null && !force) || deciding.value || !!locked,
        onClick: () => void ask(false),
      })}
    </div>
  </div>`;
}

/** @typedef {{transform: string[], sigmas: string[]}} Typed */

/** @param {{from: number, to: number, typed: Typed, onChange: (typed: Typed) => void}} props */
function Numbers({ from, to, typed, onChange }) {
  const row = (/** @type {"transform" | "sigmas"} */ name, /** @type {string} */ title) => html`<fieldset class="axes">
    <legend class="small quiet">${title}</legend>
    ${AXES.map((label, k) =>
      h(NumberField, { key: label, label, value: typed[name][k], onChange: (value) => onChange({ ...typed, [name]: typed[name].map((one, i) => (i === k ? value : one)) }) }),
    )}
  </fieldset>`;
  return html`<div>${row("transform", `Pose of node ${to} as seen from node ${from}`)}${row("sigmas", "Sigma of each; 0 where nothing is known")}</div>`;
}

/** @param {import("./link.js").LinkDetail | null} known @param {number} from @returns {Typed} */
function start(known, from) {
  if (!known?.transform || known.from !== from) return { transform: ZEROS, sigmas: SIGMAS };
  const sigmas = known.sigma_m && known.sigma_deg ? [...known.sigma_m, ...known.sigma_deg] : SIGMAS.map(Number);
  return { transform: fields(known.transform), sigmas: sigmas.map((value) => (value > 99 ? "0" : value.toFixed(4))) };
}

/** @param {number[]} pose x y z qx qy qz qw */
function fields(pose) {
  return [...pose.slice(0, 3), ...rollPitchYaw(pose)].map((value) => value.toFixed(4));
}

/** @param {{seen: Result, done: boolean}} props */
function Outcome({ seen, done }) {
  const { link, matches, inliers, icp, residuals_m: residuals, reason, decision } = seen;
  /** @type {import("./facts.js").Fact[]} */
  const facts = [];
  if (link) facts.push(["Link", `${link.from} → ${link.to}`], ["Translation", translationText(link.transform)], ["Rotation", rotationText(link.transform)]);
  if (link) facts.push(["Sigma", `${text.length(Math.max(...link.sigmas.slice(0, 3)))} · ${text.fixed(Math.max(...link.sigmas.slice(3)), 2)} °`, "Largest of the three axes"]);
  if (matches) facts.push(["Inliers", `${inliers} of ${matches}`]);
  if (icp) facts.push(["Clouds", `${text.fixed(100 * icp.ratio, 0)} % agree, guess corrected by ${text.length(icp.translation_m)} and ${text.fixed(icp.rotation_deg, 1)} °`]);
  if (residuals) facts.push(["Points", `at most ${text.length(Math.max(...residuals))} off`]);
  return html`<div class="outcome" role="status" id="link-outcome">
    ${facts.length > 0 && h(Facts, { facts })}
    ${reason && html`<p class="why why-bad">${link ? "It speaks against it" : "Nothing was found"}: ${reason.text}.</p>`}
    ${decision && html`<p class="small">${done ? "Done:" : "It would do this:"} ${effectParts(decision.effect)}</p>`}
  </div>`;
}
