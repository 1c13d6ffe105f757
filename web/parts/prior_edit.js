// A node's pose prior by hand, and the offer to let priors count where a parameter keeps them from it.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { deciding, priorAsk } from "../actions.js";
import { get } from "../api.js";
import { openMapId } from "../router.js";
import { graphRevision } from "../store.js";
import { Button } from "./button.js";
import { lockReason } from "./decision_bar.js";
import { EditDialog } from "./edit_dialog.js";
import { CheckField, NumberField } from "./inputs.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["NodePriorState"]} State */

const AXES = ["x (m)", "y (m)", "z (m)", "roll (°)", "pitch (°)", "yaw (°)"];
const SIGMAS = ["0.05", "0.05", "0.05", "1", "1", "1"];
const IGNORED = "Optimizer/PriorsIgnored";

/** @param {{id: number, key?: unknown}} props */
export function PriorEdit({ id }) {
  const [open, setOpen] = useState(false);
  return html`<details class="fold" id="prior" onToggle=${(/** @type {{currentTarget: HTMLDetailsElement}} */ { currentTarget }) => setOpen(currentTarget.open)}>
    <summary>Pose prior</summary>
    ${open && h(Prior, { id })}
  </details>`;
}

/** @typedef {{prior: {transform: number[], sigmas: number[], count: boolean} | null, known: boolean}} Wanted prior: null to remove it */

/** @param {{id: number}} props */
function Prior({ id }) {
  const map = /** @type {string} */ (openMapId.value);
  const { data, error, reload } = useFetched((signal) => get("/api/maps/{map}/nodes/{node_id}/prior", { path: { map, node_id: id }, signal }), [map, id]);
  // Here and not in the form, which begins anew when the prior is another.
  const [asked, setAsked] = useState(/** @type {Wanted | null} */ (null));
  useChanged(graphRevision, reload, 300);
  return html`${error.value
    ? html`<p class="note" role="alert">${error.value.message}</p>`
    : data.value
      ? h(Form, { key: JSON.stringify(data.value.transform), state: data.value, onAsk: setAsked })
      : html`<p class="quiet small">Looking at the prior…</p>`}
  ${asked && h(EditDialog, { ...dialog(id, asked), onDecided: () => undefined, onClose: () => (setAsked(null), reload()) })}`;
}

/** @param {number} id @param {Wanted} wanted */
function dialog(id, { prior, known }) {
  return {
    label: `Prior of node ${id}`,
    heading: () => (prior === null ? `Take the prior of node ${id} away?` : known ? `Change the prior of node ${id}?` : `Give node ${id} a prior?`),
    past: () => (prior === null ? `Node ${id} has no prior any more` : `Node ${id} has this prior`),
    verb: () => (prior === null ? "Remove" : known ? "Change" : "Add"),
    kind: /** @type {"bad" | "good"} */ (prior === null ? "bad" : "good"),
    ask: priorAsk(id, prior ?? { transform: null, sigmas: null, count: false }),
  };
}

/** @param {{state: State, onAsk: (wanted: Wanted) => void, key?: unknown}} props */
function Form({ state, onAsk }) {
  const known = state.transform !== null;
  const [pose, setPose] = useState(() => (state.transform ?? state.suggested).map((value) => value.toFixed(3)));
  const [sigmas, setSigmas] = useState(() => state.sigmas?.map((value) => String(Number(value.toFixed(4)))) ?? SIGMAS);
  const [count, setCount] = useState(false);
  const locked = lockReason();
  const off = locked !== null || deciding.value;
  const numbers = { transform: pose.map(Number), sigmas: sigmas.map(Number), count: count && state.ignored };
  return html`<div class="link-form">
    <p class="small quiet">${known ? "This node has a prior: it says where the node is in the map." : "This node has no prior. One would say where the node is in the map; it begins where the node is now."}</p>
    ${state.ignored &&
    html`<div class="note" id="priors-ignored">
      <b>${IGNORED}</b> is on: a prior is stored, but moves no pose.
      ${h(CheckField, { label: "Let priors count", hint: `Switch ${IGNORED} off with this prior, for all priors of the map; undo switches it on again`, on: count, onChange: setCount })}
    </div>`}
    ${axes("Pose in the map", pose, setPose)} ${axes("Sigma of each; three 0 for the angles: only the position is known", sigmas, setSigmas)}
    <div class="form-row">
      <span class="grow"></span>
      ${known && h(Button, { id: "prior-remove", label: "Remove…", hint: locked ?? "Take the prior away; undo brings it back", disabled: off, onClick: () => onAsk({ prior: null, known }) })}
      ${h(Button, { id: "prior-set", label: known ? "Change…" : "Add…", kind: "accent", hint: locked ?? "You see first what it would do", disabled: off, onClick: () => onAsk({ prior: numbers, known }) })}
    </div>
  </div>`;
}

/** @param {string} title @param {string[]} values @param {(values: string[]) => void} onChange */
function axes(title, values, onChange) {
  return html`<fieldset class="axes">
    <legend class="small quiet">${title}</legend>
    ${AXES.map((label, k) => h(NumberField, { key: label, label, value: values[k], onChange: (value) => onChange(values.map((one, i) => (i === k ? value : one))) }))}
  </fieldset>`;
}
