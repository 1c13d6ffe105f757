// A node's pose prior by hand, and the offer to let priors count where a parameter keeps them from it.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { deciding, priorAsk, setParameters } from "../actions.js";
import { get } from "../api.js";
import { openMapId } from "../router.js";
import { graphRevision } from "../store.js";
import { Button } from "./button.js";
import { lockReason } from "./decision_bar.js";
import { EditDialog } from "./edit_dialog.js";
import { NumberField } from "./inputs.js";
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

/** @param {{id: number}} props */
function Prior({ id }) {
  const map = /** @type {string} */ (openMapId.value);
  const { data, error, reload } = useFetched((signal) => get("/api/maps/{map}/nodes/{node_id}/prior", { path: { map, node_id: id }, signal }), [map, id]);
  useChanged(graphRevision, reload, 300);
  if (error.value) return html`<p class="note" role="alert">${error.value.message}</p>`;
  if (!data.value) return html`<p class="quiet small">Looking at the prior…</p>`;
  return h(Form, { key: JSON.stringify(data.value.transform), id, state: data.value, onDone: reload });
}

/** @param {{id: number, state: State, onDone: () => void, key?: unknown}} props */
function Form({ id, state, onDone }) {
  const known = state.transform !== null;
  const [pose, setPose] = useState(() => (state.transform ?? state.suggested).map((value) => value.toFixed(3)));
  const [sigmas, setSigmas] = useState(() => state.sigmas?.map((value) => String(Number(value.toFixed(4)))) ?? SIGMAS);
  const [asked, setAsked] = useState(/** @type {"set" | "remove" | null} */ (null));
  const locked = lockReason();
  const off = locked !== null || deciding.value;
  const numbers = { transform: pose.map(Number), sigmas: sigmas.map(Number) };
  const letCount = async () => void ((await setParameters({ [IGNORED]: false })) && onDone());
  return html`<div class="link-form">
    <p class="small quiet">${known ? "This node has a prior: it says where the node is in the map." : "This node has no prior. One would say where the node is in the map; it begins where the node is now."}</p>
    ${state.ignored &&
    html`<div class="note form-row" id="priors-ignored">
      <span class="grow"><b>${IGNORED}</b> is on: a prior is stored, but moves no pose.</span>
      ${h(Button, { id: "priors-count", label: "Let priors count", hint: locked ?? `Switch ${IGNORED} off for this map; poses follow with the next prior that is set`, disabled: off, onClick: () => void letCount() })}
    </div>`}
    ${axes("Pose in the map", pose, setPose)} ${axes("Sigma of each; three 0 for the angles: only the position is known", sigmas, setSigmas)}
    <div class="form-row">
      <span class="grow"></span>
      ${known && h(Button, { id: "prior-remove", label: "Remove…", hint: locked ?? "Take the prior away; undo brings it back", disabled: off, onClick: () => setAsked("remove") })}
      ${h(Button, { id: "prior-set", label: known ? "Change…" : "Add…", kind: "accent", hint: locked ?? "You see first what it would do", disabled: off, onClick: () => setAsked("set") })}
    </div>
    ${asked &&
    h(EditDialog, {
      label: `Prior of node ${id}`,
      heading: () => (asked === "remove" ? `Take the prior of node ${id} away?` : known ? `Change the prior of node ${id}?` : `Give node ${id} a prior?`),
      past: () => (asked === "remove" ? `Node ${id} has no prior any more` : `Node ${id} has this prior`),
      verb: () => (asked === "remove" ? "Remove" : known ? "Change" : "Add"),
      kind: asked === "remove" ? "bad" : "good",
      ask: priorAsk(id, asked === "remove" ? { transform: null, sigmas: null } : numbers),
      onDecided: () => undefined,
      onClose: () => (setAsked(null), onDone()),
    })}
  </div>`;
}

/** @param {string} title @param {string[]} values @param {(values: string[]) => void} onChange */
function axes(title, values, onChange) {
  return html`<fieldset class="axes">
    <legend class="small quiet">${title}</legend>
    ${AXES.map((label, k) => h(NumberField, { key: label, label, value: values[k], onChange: (value) => onChange(values.map((one, i) => (i === k ? value : one))) }))}
  </fieldset>`;
}
