// The form that starts a run.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { startRun } from "../actions.js";
import { go } from "../router.js";
import { Button } from "./button.js";

/** @param {{close: () => void}} props */
export function NewRun({ close }) {
  const [source, setSource] = useState("tour:");
  const [name, setName] = useState("");
  const [inRealTime, setInRealTime] = useState(true);
  const [waiting, setWaiting] = useState(false);
  const start = async () => {
    setWaiting(true);
    const begun = await startRun({ source, map: name || suggested(source), params: {}, speed: inRealTime ? 1 : 0, seed: 0 });
    setWaiting(false);
    if (!begun) return;
    close();
    if (begun.map) go({ map: begun.map, view: "loops" });
  };
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
      <span>Map</span>
      <input class="field" name="map" value=${name} placeholder=${suggested(source)} onInput=${typed(setName)} />
      <small>Name of the new file in the served folder; an existing one is never overwritten.</small>
    </label>
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
}

/** A name out of the last part of the source. @param {string} source */
function suggested(source) {
  const last = source.split(/[:?]/)[0].split("/").filter(Boolean).at(-1) ?? "map";
  const now = new Date();
  const stamp = `${now.getHours()}`.padStart(2, "0") + `${now.getMinutes()}`.padStart(2, "0");
  return `${last.replace(/[^\w.-]+/g, "-")}-${stamp}`;
}
