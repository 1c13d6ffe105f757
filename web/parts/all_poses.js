// Decisions about all poses at once: those of an optimisation on trial are kept, or the map is turned as it is.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { deciding, keepAsk, turnAsk } from "../actions.js";
import { info } from "../store.js";
import { Button } from "./button.js";
import { stopReason } from "./decision_bar.js";
import { EditDialog } from "./edit_dialog.js";
import { NumberField, SelectField } from "./inputs.js";

/** @typedef {import("../store.js").Schemas["TurnMap"]["to"]} Frame */
/** @typedef {{ask: import("../optimising.js").Ask, step: number | null}} Kept step: null for the last */

/** @param {{trial: import("../optimising.js").Optimising}} props */
export function KeepPoses({ trial }) {
  // The dialog stays when what was tried has gone, for its way back.
  const [kept, setKept] = useState(/** @type {Kept | null} */ (null));
  const found = trial.found.value;
  const step = trial.step.value;
  const last = !found || step >= found.steps.length - 1;
  const locked = stopReason();
  return html`${found &&
  html`<div class="graph-keep">
      <p class="quiet small">Links stay as they are. A later decision, or mapping on, optimises anew by the map's parameters with all its links, and may move the poses again.</p>
      ${h(Button, { id: "keep-poses", label: last ? "Keep these poses…" : `Keep those of ${step ? `iteration ${step}` : "the start"}…`, hint: locked ?? "Make them the optimised poses of the map; you see first what it would do, and undo takes it back", disabled: locked !== null || deciding.value, onClick: () => setKept({ ask: trial.ask.value, step: last ? null : step }) })}
    </div>
    ${trial.ask.value.align && html`<p class="quiet small">Kept poses are where the root holds them: the alignment with the truth is for looking. To lay the map over the truth, turn it.</p>`}`}
  ${kept &&
  h(EditDialog, {
    label: "Keep these poses",
    heading: () => "Keep these poses?",
    past: () => "The map has these poses now",
    verb: () => "Keep",
    kind: "accent",
    ask: keepAsk(kept),
    onDecided: () => trial.clear(),
    onClose: () => setKept(null),
  })}`;
}

/** @type {[string, string][]} */
const FRAMES = [["", "by an angle"], ["truth", "over the ground truth"], ["gps", "over GPS (x east)"]];

export function TurnMap() {
  const [to, setTo] = useState(/** @type {Frame} */ (null));
  const [yaw, setYaw] = useState("90");
  const [asked, setAsked] = useState(false);
  const frames = FRAMES.filter(([key]) => key !== "truth" || info.value?.has_truth);
  const angle = Number(yaw);
  const locked = stopReason();
  const off = to === null && (!angle || Math.abs(angle) > 360);
  return html`<section class="graph-part" aria-label="Turn the map">
    <div class="graph-head">
      <h3 class="grow">Turn the map</h3>
      ${h(Button, { id: "turn-map", label: "Turn…", hint: locked ?? (off ? "Give an angle from -360 to 360 degrees, other than 0" : "The whole map as it is; you see first what it would do"), disabled: off || locked !== null || deciding.value, onClick: () => setAsked(true) })}
    </div>
    <div class="form-row">
      ${h(SelectField, { label: "Turned", value: to ?? "", options: frames, onChange: (value) => setTo(/** @type {Frame} */ (value || null)) })}
      ${to === null && h(NumberField, { label: "Yaw (°)", value: yaw, hint: "About the z axis of the map, counter-clockwise seen from above", onChange: setYaw })}
    </div>
    ${asked &&
    h(EditDialog, {
      label: "Turn the map",
      heading: () => (to === null ? `Turn the map by ${angle}°?` : `Lay the map ${FRAMES.find(([key]) => key === to)?.[1]}?`),
      past: () => "The map is turned",
      verb: () => "Turn",
      kind: "accent",
      ask: turnAsk({ yaw_deg: to === null ? angle : 0, to }),
      onDecided: () => undefined,
      onClose: () => setAsked(false),
    })}
  </section>`;
}
