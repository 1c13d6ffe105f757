// Parameters that are tried on the open map: the draft of their values, and the trials that the server knows of.
import { effect, signal } from "@preact/signals";
import { say, setParameters, told } from "./actions.js";
import { get, post } from "./api.js";
import { on } from "./events.js";
import { go, openMapId } from "./router.js";
import { loadMaps, parameters } from "./store.js";

/** @typedef {import("./types/http").Schemas} Schemas */
/** @typedef {Schemas["Trial"]} Trial */
/** @typedef {Schemas["Parameter"]["value"]} Value */

/** @type {import("@preact/signals").Signal<Record<string, Value>>} values that differ from those in force, by name */
export const drafted = signal({});
/** Whether changes are gathered while an engine runs; without an engine they always are. */
export const gathering = signal(false);
/** @type {import("@preact/signals").Signal<Trial[] | null>} the newest first */
export const trials = signal(null);
/** @type {import("@preact/signals").Signal<Error | null>} */
export const trialsError = signal(null);

/** Another map has another draft. */
export function startTrials() {
  effect(() => {
    void openMapId.value;
    drafted.value = {};
    gathering.value = false;
    trials.value = null;
  });
  on("trial", (value, map) => map === openMapId.value && hear(value));
}

/** @param {Trial | null} told null: one is gone */
function hear(told) {
  const known = trials.value?.find(({ number }) => number === told?.number);
  if (!told || !known || told.state !== "running") return void loadTrials();
  trials.value = /** @type {Trial[]} */ (trials.value).map((one) => (one.number === told.number ? told : one));
}

export async function loadTrials() {
  const map = openMapId.value;
  if (!map) return;
  try {
    const found = await get("/api/maps/{map}/trials", { path: { map } });
    if (map === openMapId.value) [trials.value, trialsError.value] = [found.trials, null];
  } catch (error) {
    if (map === openMapId.value) trialsError.value = /** @type {Error} */ (error);
  }
}

/** Put a value into the draft; the one in force takes it out. @param {string} name @param {Value} value @param {Value} inForce */
export function draftValue(name, value, inForce) {
  const { [name]: _, ...rest } = drafted.value;
  drafted.value = value === inForce ? rest : { ...rest, [name]: value };
}

/** Replay the map with the draft, and show how far that is. */
export async function tryDraft() {
  const map = openMapId.value;
  if (!map) return;
  const begun = await told(post("/api/maps/{map}/trials", { path: { map }, body: { changes: drafted.value } }));
  if (!begun) return;
  await loadTrials();
  if (map === openMapId.value) go({ view: "params", key: begun.number, query: { tab: "trials" } });
}

/** Have the draft in force: in the engine, or in the file for the next session. @param {boolean} live */
export async function applyDraft(live) {
  if (!(await setParameters(drafted.value))) return;
  drafted.value = {};
  say(live ? "The engine has them from the next frame on" : "The next session of this map starts with them", "good");
}

/** @param {string} map @param {Trial} trial */
export async function takeOver(map, { number, changes }) {
  const answer = await told(post("/api/maps/{map}/trials/{number}/take-over", { path: { map, number }, body: undefined }));
  if (!answer) return;
  if (map === openMapId.value) {
    parameters.value = answer.parameters;
    drafted.value = Object.fromEntries(Object.entries(drafted.value).filter(([name]) => !answer.applied.includes(name)));
  }
  const where = answer.parameters.live ? "in the running engine" : "for the map's next session";
  say(`Taken over ${where}: ${answer.applied.join(", ")}`, "good");
  if (answer.left.length) say(`Not while mapping, so left as they are: ${changes.filter(({ name }) => answer.left.includes(name)).map(({ name }) => name).join(", ")}`);
  void loadTrials();
}

/** @param {string} map @param {number} number @param {string} name */
export async function keepTrial(map, number, name) {
  const made = await told(post("/api/maps/{map}/trials/{number}/keep", { path: { map, number }, body: { name } }));
  if (made) void loadMaps();
  return made;
}

/** @param {string} map @param {number} number @param {"cancel" | "discard"} how */
export async function endTrial(map, number, how) {
  const options = { path: { map, number }, body: undefined };
  const left = await told(how === "cancel" ? post("/api/maps/{map}/trials/{number}/cancel", options) : post("/api/maps/{map}/trials/{number}/discard", options));
  if (left && map === openMapId.value) trials.value = left.trials;
}
