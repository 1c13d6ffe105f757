// Covariances of many links, typed: how far the map trusts its neighbours, loops or landmarks.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { covarianceAsk, deciding } from "../actions.js";
import * as text from "../format.js";
import { Button } from "./button.js";
import { lockReason } from "./decision_bar.js";
import { EditDialog } from "./edit_dialog.js";
import { NumberField, numbers, SelectField, Sessions } from "./inputs.js";

/** @typedef {import("../store.js").Schemas["Covariances"]} Wanted */

const AXES = ["x (m)", "y (m)", "z (m)", "roll (°)", "pitch (°)", "yaw (°)"];
const LOOPS = ["GlobalClosure", "LocalSpaceClosure", "LocalTimeClosure", "UserClosure"];
const FIRST = { of: "neighbours", first: "", last: "", intra: true, inter: true, session: "" };
/** @type {Record<string, [string, string[]]>} */
const KINDS = {
  neighbours: ["all neighbours", ["Neighbor", "NeighborMerged"]],
  loops: ["all loops", LOOPS],
  landmarks: ["all landmarks", ["Landmark"]],
  global: ["global loops", ["GlobalClosure"]],
  proximity: ["proximity", ["LocalSpaceClosure", "LocalTimeClosure"]],
  hand: ["by hand", ["UserClosure"]],
};
/** @type {[string, string][]} */
const OPTIONS = Object.entries(KINDS).map(([key, [label]]) => [key, label]);

export function Covariances() {
  const [wanted, setWanted] = useState(FIRST);
  const [sigmas, setSigmas] = useState(["0.05", "0.05", "0.05", "1", "1", "1"]);
  const [asked, setAsked] = useState(/** @type {Omit<Wanted, "author" | "preview"> | null} */ (null));
  const set = (/** @type {Partial<typeof FIRST>} */ change) => setWanted({ ...wanted, ...change });
  const locked = lockReason();
  const { of, ...rest } = wanted;
  const body = /** @type {Wanted} */ ({ ...numbers(rest), types: KINDS[of][1], sigmas: sigmas.map(Number) });
  const links = (/** @type {number | undefined} */ count) => (count === undefined ? "links" : text.plural(count, "link"));
  return html`<div class="link-form" id="covariances">
    <p class="small quiet">Sigmas of each link, in the frame of its first node; 0 where nothing is known. Transforms stay. To have them estimated by images or clouds instead, refine links with “covariances alone”.</p>
    <div class="form-row">
      ${h(SelectField, { label: "Links", value: of, options: OPTIONS, onChange: (value) => set({ of: value }) })}
      ${h(NumberField, { label: "from node", value: wanted.first, step: "1", hint: "Empty: from the first", onChange: (first) => set({ first }) })}
      ${h(NumberField, { label: "to node", value: wanted.last, step: "1", hint: "Empty: to the last", onChange: (last) => set({ last }) })}
      ${h(Sessions, { wanted, onChange: set })}
    </div>
    <fieldset class="axes">
      <legend class="small quiet">Sigma</legend>
      ${AXES.map((label, k) => h(NumberField, { key: label, label, value: sigmas[k], onChange: (value) => setSigmas(sigmas.map((one, i) => (i === k ? value : one))) }))}
    </fieldset>
    <div class="form-row">
      <span class="grow"></span>
      ${h(Button, { id: "covariances-set", label: "Set…", kind: "accent", hint: locked ?? "You see first what it would do; one undo takes all of it back", disabled: deciding.value || locked !== null, onClick: () => setAsked(body) })}
    </div>
    ${asked &&
    h(EditDialog, {
      label: "Covariances",
      heading: (said) => `Give ${links(said?.count)} these sigmas?`,
      past: (said) => `${links(said.count)} with new sigmas`,
      verb: (said) => `Set ${text.whole(said?.count)}`,
      kind: "good",
      ask: covarianceAsk(asked),
      onDecided: () => undefined,
      onClose: () => setAsked(null),
    })}
  </div>`;
}
