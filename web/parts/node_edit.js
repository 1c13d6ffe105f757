// What can be done to a node: its label, a link from it, taking it out of the map.
import { useEffect, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { deciding, dropNodes, labelNode } from "../actions.js";
import { link } from "../router.js";
import { Button } from "./button.js";
import { effectParts, lockReason } from "./decision_bar.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {import("../store.js").Schemas["DecisionResult"]} Result */

const DROPPED = -9;

/** @param {{node: NodeDetail, onDone: () => void}} props */
export function NodeEdit({ node, onDone }) {
  const [label, setLabel] = useState(node.label);
  const [foreseen, setForeseen] = useState(/** @type {Result | null} */ (null));
  useEffect(() => (setLabel(node.label), setForeseen(null)), [node.id, node.label]);
  if (node.weight === DROPPED) return null;
  const locked = lockReason();
  const foresee = async () => setForeseen(await dropNodes([node.id], true));
  const save = async () => void ((await labelNode(node.id, label)) && onDone());
  const drop = async () => void ((await dropNodes([node.id], false)) && onDone());
  return html`<section class="node-edit">
    <form class="form-row" onSubmit=${(/** @type {Event} */ event) => (event.preventDefault(), void save())}>
      <input class="field grow" type="text" maxlength="200" placeholder="No label" aria-label="Label of the node" value=${label} onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ event) => setLabel(event.currentTarget.value)} />
      ${h(Button, { id: "node-label", label: "Label", hint: locked ?? "Store the label; empty takes it away", disabled: label.trim() === node.label || deciding.value || !!locked, onClick: () => void save() })}
      <a class="button button-plain" href=${link({ view: "loops", query: { tab: "link", from: String(node.id) } })}>Link…</a>
      ${h(Button, { id: "node-drop", label: "Remove…", hint: locked ?? "Take the node out of the map; odometry is bridged over it, and undo brings it back", disabled: deciding.value || !!locked, onClick: () => void foresee() })}
    </form>
    ${foreseen &&
    html`<div class="note" role="status">
      <p>Node ${node.id} would leave the map: ${effectParts(foreseen.effect)}</p>
      <div class="form-row"><span class="grow"></span>
        ${h(Button, { label: "Keep it", onClick: () => setForeseen(null) })}
        ${h(Button, { id: "node-drop-do", label: "Remove", kind: "bad", disabled: deciding.value, onClick: () => void drop() })}
      </div>
    </div>`}
  </section>`;
}
