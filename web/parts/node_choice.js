// Several nodes of the table chosen together: by clicks with Shift and Ctrl, as a stretch, or all that the filter shows.
import { useEffect, useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { deciding, dropAsk, labelAsk, say } from "../actions.js";
import * as text from "../format.js";
import { Button } from "./button.js";
import { lockReason, stopReason } from "./decision_bar.js";
import { EditDialog } from "./edit_dialog.js";
import { NumberField } from "./inputs.js";

/** @typedef {import("../window.js").Window} Window */
/** @typedef {{label: string} | "drop"} Wanted */

/**
 * @typedef {object} Choice
 * @property {Set<number>} ids
 * @property {(row: number, event: MouseEvent | undefined, at: number) => boolean} click whether the click was about the choice
 * @property {(first: number, last: number) => Promise<void>} rows choose a range of rows
 * @property {(ids: number[]) => void} choose
 */

/** @param {Window} rows @returns {Choice} */
export function useChoice(rows) {
  const [ids, setIds] = useState(/** @type {Set<number>} */ (new Set()));
  const anchor = useRef(-1);
  useEffect(() => setIds(new Set()), [rows]);
  const choose = (/** @type {number[]} */ chosen) => setIds(new Set(chosen));
  const range = async (/** @type {number} */ first, /** @type {number} */ last) => {
    try {
      choose(await rows.ids(first, last));
    } catch (error) {
      say(/** @type {Error} */ (error).message);
    }
  };
  const click = (/** @type {number} */ row, /** @type {MouseEvent | undefined} */ event, /** @type {number} */ at) => {
    const from = anchor.current >= 0 ? anchor.current : at;
    if (event?.shiftKey && from >= 0) {
      void range(Math.min(from, row), Math.max(from, row) + 1);
      return true;
    }
    anchor.current = row;
    const id = rows.at(row)?.id;
    if (!event || !(event.ctrlKey || event.metaKey) || id === undefined) {
      if (ids.size) choose([]);
      return false;
    }
    // The node that is shown belongs to it, as in any list.
    const open = ids.size ? undefined : rows.at(at)?.id;
    const next = new Set(open === undefined ? ids : [open]);
    if (!next.delete(id)) next.add(id);
    setIds(next);
    return true;
  };
  return { ids, click, rows: range, choose };
}

/** @param {{choice: Choice, rows: Window, onDone: () => void}} props */
export function ChoiceBar({ choice, rows, onDone }) {
  const [first, setFirst] = useState("");
  const [last, setLast] = useState("");
  const [label, setLabel] = useState("");
  const [asked, setAsked] = useState(/** @type {{wanted: Wanted, ids: number[]} | null} */ (null));
  const ids = [...choice.ids].sort((a, b) => a - b);
  const [locked, held] = [lockReason(), stopReason()];
  const off = !ids.length || locked !== null || deciding.value;
  const stretch = async () => choice.choose(await rows.stretch(Number(first), Number(last)));
  const ask = (/** @type {Wanted} */ wanted) => setAsked({ wanted, ids });
  return html`<div class="view-tools bulk choice" id="choice">
    <div class="form-row">
      <span class="small ${ids.length ? "" : "quiet"} grow clip" role="status" title="Shift click chooses all rows as far as there, Ctrl click one more">${ids.length ? html`<b>${text.plural(ids.length, "node")}</b> chosen` : html`<span class="with-keys">Several: Shift, Ctrl</span><span class="without-keys">Several</span>`}</span>
      ${h(NumberField, { label: "Stretch", value: first, step: "1", hint: "First node of a stretch", onChange: setFirst })}
      ${h(NumberField, { label: "to", value: last, step: "1", hint: "Last node of a stretch", onChange: setLast })}
      ${h(Button, { id: "choose-stretch", label: "Choose", hint: "All nodes from the one to the other", disabled: !(Number(first) > 0 && Number(last) >= Number(first)), onClick: () => void stretch() })}
      ${ids.length
        ? h(Button, { id: "choose-none", label: "None", hint: "Choose none", onClick: () => choice.choose([]) })
        : h(Button, { id: "choose-all", label: "All", hint: "Choose all nodes that the filter shows", disabled: !rows.total, onClick: () => void choice.rows(0, rows.total) })}
    </div>
    ${ids.length > 0 &&
    html`<div class="form-row">
      <input class="field grow" type="text" maxlength="180" placeholder=${ids.length > 1 ? "Label: numbered 1, 2, 3…" : "Label"} aria-label="Label of the chosen nodes" value=${label} onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ event) => setLabel(event.currentTarget.value)} />
      ${h(Button, { id: "label-chosen", label: label.trim() ? "Label…" : "Unlabel…", hint: locked ?? "Label them, numbered by their ids; empty takes their labels away", disabled: off, onClick: () => ask({ label: label.trim() }) })}
      ${h(Button, { id: "drop-chosen", label: "Remove…", kind: "bad", hint: held ?? "Take them out of the map; odometry is bridged over every gap, and one undo brings all back", disabled: off || held !== null, onClick: () => ask("drop") })}
    </div>`}
    ${asked && h(EditDialog, { ...dialog(asked), onDecided: () => (asked.wanted === "drop" && choice.choose([]), onDone()), onClose: () => setAsked(null) })}
  </div>`;
}

/** @param {{wanted: Wanted, ids: number[]}} asked */
function dialog({ wanted, ids }) {
  const nodes = text.plural(ids.length, "node");
  const range = ids.length > 1 ? `${nodes} from ${ids[0]} to ${ids[ids.length - 1]}` : `node ${ids[0]}`;
  if (wanted === "drop") {
    return {
      label: "Remove nodes",
      heading: () => `Take ${range} out of the map?`,
      past: () => `${nodes} left the map`,
      verb: () => `Remove ${text.whole(ids.length)}`,
      kind: /** @type {"bad"} */ ("bad"),
      ask: dropAsk(ids),
    };
  }
  const given = (/** @type {import("../store.js").Schemas["DecisionResult"] | null} */ said) => text.plural(said?.count ?? ids.length, "node");
  return {
    label: "Label nodes",
    heading: (/** @type {import("../store.js").Schemas["DecisionResult"] | null} */ said) => (wanted.label ? `Label ${given(said)} “${wanted.label}${ids.length > 1 ? " 1…" : ""}”?` : `Take the labels of ${given(said)} away?`),
    past: (/** @type {import("../store.js").Schemas["DecisionResult"]} */ said) => `${given(said)} ${wanted.label ? "labelled" : "without a label now"}`,
    verb: () => (wanted.label ? "Label" : "Unlabel"),
    kind: /** @type {"good"} */ ("good"),
    ask: labelAsk(ids, wanted.label),
  };
}
