// What nodes are coloured by: a few of the graph's own, and any number that is stored of them.
import { signal } from "@preact/signals";
import { html } from "../html.js";
import { setScene } from "../actions.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { graphRevision, scene } from "../store.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {import("../types/http").Schemas["NodeValues"]} NodeValues */

const OWN = ["memory", "session", "time", "weight"];
const WORDS = /** @type {Record<string, string>} */ ({ residual: "worst residual", altitude: "GPS altitude" });

/** Names for a menu: what the page shows at once is asked for before. */
const LATER_MS = 1500;

/** The scale of what is shown, null for the graph's own. @type {import("@preact/signals").Signal<NodeValues | null>} */
export const shownScale = signal(null);

/** @param {{map: string, key?: unknown}} props */
export function Colouring({ map }) {
  const now = scene.value;
  const colour = now?.colour ?? OWN[0];
  const { data } = useFetched(async (signal) => {
    await waited(LATER_MS);
    return get("/api/maps/{map}/node-values", { path: { map }, signal });
  }, [map]);
  const scale = useFetched(
    (signal) => (OWN.includes(colour) ? null : get("/api/maps/{map}/node-values/{name}", { path: { map, name: colour }, signal })),
    [map, colour],
  );
  useChanged(graphRevision, scale.reload, 3000);
  const found = scale.data.value;
  const fits = found !== null && found.name === colour ? found : null;
  if (shownScale.peek() !== fits) queueMicrotask(() => (shownScale.value = fits));
  const names = data.value?.names ?? (OWN.includes(colour) ? [] : [colour]);
  const group = (/** @type {string} */ start) => names.filter((name) => name.startsWith(start));
  const plain = names.filter((name) => !name.includes(":"));
  return html`<label class="chip chip-select scene-colour">
    Colour
    <select disabled=${!now} value=${colour} onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => void setScene({ colour: currentTarget.value })}>
      ${[...OWN, ...plain].map(option)}
      ${group("sensor:").length > 0 && html`<optgroup label="Sensors">${group("sensor:").map(option)}</optgroup>`}
      ${group("stat:").length > 0 && html`<optgroup label="Statistics">${group("stat:").map(option)}</optgroup>`}
    </select>
  </label>`;
}

/** @param {number} ms @returns {Promise<void>} */
function waited(ms) {
  return new Promise((done) => void setTimeout(done, ms));
}

/** @param {string} name */
function option(name) {
  return html`<option key=${name} value=${name}>${labelOf(name)}</option>`;
}

/** @param {string} name */
export function labelOf(name) {
  return WORDS[name] ?? name.replace(/^(sensor|stat):/, "").replace(/\/$/, "");
}

/** An end of the scale with its unit. @param {NodeValues} scale @param {number} value */
export function endOf({ unit }, value) {
  return `${text.short(value)}${unit ? ` ${unit}` : ""}`;
}
