// What more than one part of the page shows. Views fetch what only they show.
import { batch, effect, signal, untracked } from "@preact/signals";
import { get } from "./api.js";
import { Columns } from "./columns.js";
import { on, openings } from "./events.js";
import { openMapId, route } from "./router.js";
import { viewer } from "./viewer.js";

/** @typedef {import("./types/http").Schemas} Schemas */
/** @typedef {{kind: "node", id: number} | {kind: "link", from: number, to: number}} Selection */
/**
 * @template T
 * @typedef {import("@preact/signals").Signal<T>} Signal
 */

/** @type {Signal<Schemas["MapSummary"][] | null>} */
export const maps = signal(null);
/** @type {Signal<Error | null>} */
export const mapsError = signal(null);
/** @type {Signal<Schemas["MapInfo"] | null>} */
export const info = signal(null);
/** @type {Signal<Error | null>} */
export const infoError = signal(null);
/** @type {Signal<Schemas["Session"] | null>} */
export const session = signal(null);
/** @type {Signal<string | null>} the failure that somebody has read and put away */
export const readFailure = signal(null);
/** @type {Signal<Schemas["Scene"] | null>} */
export const scene = signal(null);
/** @type {Signal<Schemas["ParameterSet"] | null>} */
export const parameters = signal(null);
/** @type {Signal<Columns | null>} */
export const columns = signal(null);
/** @type {Signal<Selection | null>} */
export const selection = signal(null);
/** @type {Signal<number>} grows whenever the graph of the open map changed */
export const graphRevision = signal(0);

const INFO_EVERY_MS = 2000;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let growing;

/** Value in force of a parameter of the open map. @param {string} name */
export function inForce(name) {
  return parameters.value?.parameters.find((one) => one.name === name)?.value;
}

export async function loadMaps() {
  try {
    maps.value = (await get("/api/maps", {})).maps;
    mapsError.value = null;
  } catch (error) {
    mapsError.value = /** @type {Error} */ (error);
  }
}

export async function loadInfo() {
  const map = openMapId.value;
  if (!map) return;
  try {
    const found = await get("/api/maps/{map}", { path: { map } });
    if (map === openMapId.value) batch(() => ((info.value = found), (infoError.value = null)));
  } catch (error) {
    if (map === openMapId.value) infoError.value = /** @type {Error} */ (error);
  }
}

export async function loadParameters() {
  const map = openMapId.value;
  if (!map) return;
  const found = await get("/api/maps/{map}/parameters", { path: { map } }).catch(() => null);
  if (map === openMapId.value && found) parameters.value = found;
}

async function loadSession() {
  const found = await get("/api/session", {}).catch(() => null);
  if (found) session.value = found;
}

/** What the 3D view shows, unless something newer is known. @param {Schemas["Scene"]} found */
export function takeScene(found) {
  if (!scene.value || found.revision >= scene.value.revision) scene.value = found;
}

async function loadScene() {
  const map = openMapId.value;
  if (!map) return;
  const found = await get("/api/scene/{map}", { path: { map }, query: { viewer } }).catch(() => null);
  if (map === openMapId.value && found) takeScene(found);
}

/** Forget the last map and fetch the frame of the next; its views fetch the rest. */
function switchMap() {
  const map = openMapId.value;
  batch(() => {
    info.value = null;
    infoError.value = null;
    scene.value = null;
    parameters.value = null;
    selection.value = null;
    columns.value = map ? new Columns(map) : null;
  });
  void Promise.all([loadInfo(), loadParameters(), loadScene()]);
}

/** While a map grows its counts are fetched again, but not for every node. */
function followGrowth() {
  if (graphRevision.value === 0 || growing) return;
  growing = setTimeout(() => {
    growing = undefined;
    void loadInfo();
  }, INFO_EVERY_MS);
}

/** Start following the address and the stream. */
export function startStore() {
  effect(() => void (openMapId.value, untracked(switchMap)));
  effect(() => void (openings.value > 0 && untracked(refresh)));
  effect(followRoute);
  effect(followGrowth);
  listen();
}

/** The stream is open: fetch what it doesn't bring; when it was broken, also what was missed meanwhile. */
function refresh() {
  void Promise.all([loadMaps(), loadSession()]);
  if (openings.value === 1) return;
  void Promise.all([loadInfo(), loadParameters(), loadScene()]);
  columns.value?.pull();
  graphRevision.value += 1;
}

/** @type {{map: string | null, id: number} | null} the first of two nodes beside each other, as long as they are */
let firstOfTwo = null;

function followRoute() {
  const { view, key, query } = route.value;
  const ids = (key ?? "").split("-").map(Number);
  const beside = view === "nodes" ? Number(query.get("b")) : 0;
  const isPair = Boolean(key) && Number.isInteger(beside) && beside > 0 && beside !== ids[0];
  // Two that nothing links are marked together only while one looks at them.
  if (!isPair && firstOfTwo && firstOfTwo.map === openMapId.value) selection.value = { kind: "node", id: firstOfTwo.id };
  firstOfTwo = isPair ? { map: openMapId.value, id: ids[0] } : null;
  if (!key || ids.some((id) => !Number.isInteger(id))) return;
  if (isPair) selection.value = { kind: "link", from: ids[0], to: beside };
  else if (view === "nodes" && ids.length === 1) selection.value = { kind: "node", id: ids[0] };
  if (view === "loops" && ids.length === 2) selection.value = { kind: "link", from: ids[0], to: ids[1] };
}

function listen() {
  on("session", (value) => (session.value = value));
  on("update", (_, map) => map === openMapId.value && columns.value?.pull());
  on("scene", (value, map) => map === openMapId.value && value.viewer === viewer && takeScene(value));
  on("graph", (_, map) => map === openMapId.value && (graphRevision.value += 1));
  on("parameters", (value, map) => map === openMapId.value && echo(value));
}

/** Take over values as the engine reports them. @param {Record<string, unknown>} values */
function echo(values) {
  const set = parameters.value;
  if (!set) return;
  const heard = set.parameters.map((one) => (one.name in values ? { ...one, value: values[one.name] } : one));
  parameters.value = /** @type {Schemas["ParameterSet"]} */ ({ ...set, parameters: heard });
}
