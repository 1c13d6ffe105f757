// The parameters that somebody has changed without applying them: try them on the map, apply them, or let them be.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { applyDraft, drafted, draftValue, trials, tryDraft } from "../trials.js";
import { Button } from "./button.js";
import { valueText } from "./parameter.js";

/** @param {{set: import("../store.js").Schemas["ParameterSet"]}} props */
export function DraftBar({ set }) {
  const [waiting, setWaiting] = useState(false);
  const changes = set.parameters.filter(({ name }) => name in drafted.value);
  const running = trials.value?.some(({ state }) => state === "running") ?? false;
  const carryOut = async (/** @type {() => Promise<void>} */ work) => {
    setWaiting(true);
    await work();
    setWaiting(false);
  };
  if (!changes.length) return null;
  return html`<div class="draft-bar" id="draft-bar" role="group" aria-label="Changed values">
    <ul class="draft-list small">
      ${changes.map(
        ({ name, value }) => html`<li key=${name}>
          <span class="clip">${name}</span> ${valueText(value)} → <b>${valueText(drafted.value[name])}</b>
          ${h(Button, { icon: "close", kind: "bare", hint: `Leave ${name} as it is`, onClick: () => draftValue(name, value, value) })}
        </li>`,
      )}
    </ul>
    <div class="form-row">
      ${h(Button, {
        id: "draft-try",
        label: "Try on this map",
        kind: "accent",
        hint: running ? "A trial is under way: wait for it, or cancel it" : "Replay the map's nodes with these values, and compare; the map stays as it is",
        disabled: waiting || running,
        onClick: () => void carryOut(tryDraft),
      })}
      ${h(Button, {
        id: "draft-apply",
        label: "Apply",
        hint: set.live ? "Set them in the running engine, from the next frame on" : "Write them into the map: its next session starts with them",
        disabled: waiting,
        onClick: () => void carryOut(() => applyDraft(set.live)),
      })}
      ${h(Button, { label: "Clear", hint: "Leave all values as they are", onClick: () => (drafted.value = {}) })}
    </div>
  </div>`;
}
