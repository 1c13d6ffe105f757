// The form that starts a run.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { startRun } from "../actions.js";
import { go, openMapId } from "../router.js";
import { maps } from "../store.js";
import { Button } from "./button.js";

/** @typedef {import("../store.js").Schemas["StartRun"]["mode"]} Mode */

const MODES = /** @type {[Mode, string][]} */ ([
  ["new", "A new map"],
  ["append", "A new session of a map"],
  ["localize", "Localise in a map"],
]);

/** @param {{close: () => void}} props */
export function NewRun({ close }) {
  const [source, setSource] = useState("tour:");
  const [name, setName] = useState("");
  const [mode, setMode] = useState(/** @type {Mode} */ ("new"));
  const [onto, setOnto] = useState(openMapId.value ?? "");
  const [inRealTime, setInRealTime] = useState(true);
  const [waiting, setWaiting] = useState(false);
  const start = async () => {
    setWaiting(true);
    const map = mode === "new" ? name || suggested(source) : onto;
    const begun = await startRun({ source, map, mode, params: {}, speed: inRealTime ? 1 : 0, seed: 0 });
    setWaiting(false);
    if (!begun) return;
    close();
    if (begun.map) go({ map: begun.map, view: "loops" });
  };
  const usable = maps.value?.filter(({ error, nodes }) => !error && nodes) ?? [];
  const chosen = (/** @type {(value: any) => void} */ set) => (/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) =>
    set(currentTarget.value);
  const typed = (/** @type {(text: string) => void} */ set) => (/** @type {{currentTarget: HTMLInputElement}} */ event) =>
    set(event.currentTarget.value);
  return html`<form
    class="form"
    aria-label="New run"
    onSubmit=${(/** @type {Event} */ event) => (event.preventDefault(), void start())}
  >
    <label>
      <span>Source</span>
      <input class="field" name="source" value=${source} required onInput=${typed(setSource)} />
      <small>A folder in TUM RGB-D form on the server, or <code>tour:</code> for the rendered room.</small>
    </label>
    <label>
      <span>Into</span>
      <select class="field" name="mode" value=${mode} onChange=${chosen(setMode)}>
        ${MODES.map(([value, label]) => html`<option key=${value} value=${value} disabled=${value !== "new" && !usable.length}>${label}</option>`)}
      </select>
    </label>
    ${mode === "new" ? newMap() : oldMap()}
    <label class="form-check">
      <input
        type="checkbox"
        checked=${inRealTime}
        onChange=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => setInRealTime(currentTarget.checked)}
      />
      <span>As fast as it was recorded; otherwise as fast as this machine can</span>
    </label>
    <div class="form-buttons">
      <button type="submit" class="button button-accent" disabled=${waiting}>${waiting ? "Starting" : "Start"}</button>
      ${h(Button, { label: "Cancel", onClick: close })}
    </div>
  </form>`;

  function newMap() {
    return html`<label>
      <span>Map</span>
      <input class="field" name="map" value=${name} placeholder=${suggested(source)} onInput=${typed(setName)} />
      <small>Name of the new file in the served folder; an existing one is never overwritten.</small>
    </label>`;
  }

  function oldMap() {
    return html`<label>
      <span>Map</span>
      <select class="field" name="onto" required value=${onto} onChange=${chosen(setOnto)}>
        <option value="" disabled>Choose a map</option>
        ${usable.map((map) => html`<option key=${map.id} value=${map.id}>${map.name}</option>`)}
      </select>
      <small>
        ${mode === "append"
          ? "The new session is a graph of its own until a loop joins it with what is there."
          : "The map stays as it is; the robot's pose in it is told with its covariance."}
      </small>
    </label>`;
  }
}

/** A name out of the last part of the source. @param {string} source */
function suggested(source) {
  const last = source.split(/[:?]/)[0].split("/").filter(Boolean).at(-1) ?? "map";
  const now = new Date();
  const stamp = `${now.getHours()}`.padStart(2, "0") + `${now.getMinutes()}`.padStart(2, "0");
  return `${last.replace(/[^\w.-]+/g, "-")}-${stamp}`;
}
