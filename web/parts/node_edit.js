// What can be done to a node: its label, a link from it, a prior, taking it out of the map.
import { useEffect, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { deciding, dropAsk, labelNode } from "../actions.js";
import { link } from "../router.js";
import { Button } from "./button.js";
import { lockReason, stopReason } from "./decision_bar.js";
import { EditDialog } from "./edit_dialog.js";
import { PriorEdit } from "./prior_edit.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */

const DROPPED = -9;

/** @param {{node: NodeDetail, onDone: () => void}} props */
export function NodeEdit({ node, onDone }) {
  const [label, setLabel] = useState(node.label);
  const [asked, setAsked] = useState(false);
  useEffect(() => setLabel(node.label), [node.id, node.label]);
  useEffect(() => setAsked(false), [node.id]);
  // What taking it out did is said until somebody closes it.
  const dropped = node.weight === DROPPED;
  if (dropped && !asked) return null;
  const [locked, held] = [lockReason(), stopReason()];
  const save = async () => void ((await labelNode(node.id, label)) && onDone());
  return html`<section class="node-edit">
    ${!dropped && html`<form class="form-row" onSubmit=${(/** @type {Event} */ event) => (event.preventDefault(), void save())}>
      <input class="field grow" type="text" maxlength="200" placeholder="No label" aria-label="Label of the node" value=${label} onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ event) => setLabel(event.currentTarget.value)} />
      ${h(Button, { id: "node-label", label: "Label", hint: locked ?? "Store the label; empty takes it away", disabled: label.trim() === node.label || deciding.value || !!locked, onClick: () => void save() })}
      <a class="button button-plain" href=${link({ view: "loops", query: { tab: "link", from: String(node.id) } })}>Link…</a>
      ${h(Button, { id: "node-drop", label: "Remove…", hint: held ?? "Take the node out of the map; odometry is bridged over it, and undo brings it back", disabled: deciding.value || !!held, onClick: () => setAsked(true) })}
    </form>`}
    ${!dropped && h(PriorEdit, { key: node.id, id: node.id })}
    ${asked &&
    h(EditDialog, {
      label: `Remove node ${node.id}`,
      heading: () => `Take node ${node.id} out of the map?`,
      past: () => `Node ${node.id} left the map`,
      verb: () => "Remove",
      kind: "bad",
      ask: dropAsk([node.id]),
      onDecided: onDone,
      onClose: () => setAsked(false),
    })}
  </section>`;
}
