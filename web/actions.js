// What a person can make the server do; each failure becomes one message on the page.
import { signal } from "@preact/signals";
import { patch, post } from "./api.js";
import { remembered } from "./prefs.js";
import { graphRevision, loadInfo, parameters, takeScene } from "./store.js";
import { openMapId } from "./router.js";
import { viewer } from "./viewer.js";

/** @typedef {import("./types/http").Schemas} Schemas */
/** @typedef {{id: number, kind: "bad" | "good", text: string}} Toast */

/** @type {import("@preact/signals").Signal<Toast[]>} */
export const toasts = signal([]);
/** @type {import("@preact/signals").Signal<{map: string, made: Schemas["DecisionResult"]} | null>} what the last decision did, and to which map */
export const lastDecision = signal(null);

/** Whether a decision is being carried out. */
export const deciding = signal(false);
/** Who decides at this browser. */
export const author = remembered("author", "");

let toastCount = 0;

/** What stands there already is not said twice. @param {string} text @param {Toast["kind"]} [kind] */
export function say(text, kind = "bad") {
  if (toasts.value.some((toast) => toast.text === text)) return;
  const id = ++toastCount;
  toasts.value = [...toasts.value, { id, kind, text }];
  setTimeout(() => dismiss(id), kind === "bad" ? 8000 : 4000);
}

/** @param {number} id */
export function dismiss(id) {
  toasts.value = toasts.value.filter((toast) => toast.id !== id);
}

/**
 * @template T
 * @param {Promise<T>} work
 * @returns {Promise<T | null>} null when it failed, and that was said
 */
export async function told(work) {
  try {
    return await work;
  } catch (error) {
    say(/** @type {Error} */ (error).message);
    return null;
  }
}

/**
 * The stream tells what becomes of it; the answer may come after news that are newer.
 * @param {"pause" | "resume" | "step" | "stop"} command
 */
export const command = (command) => told(post("/api/session/{command}", { path: { command }, body: undefined }));

/** @param {Schemas["StartRun"]} run */
export const startRun = (run) => told(post("/api/session", { body: run }));

/** @param {Schemas["SceneChange"]} change */
export async function setScene(change) {
  const map = openMapId.value;
  if (!map) return;
  const answer = await told(patch("/api/scene/{map}", { path: { map }, query: { viewer }, body: change }));
  if (answer && map === openMapId.value) takeScene(answer);
}

/** Bring the camera of the 3D view to the selected node. */
export async function lookAtSelected() {
  const map = openMapId.value;
  if (map) await told(post("/api/scene/{map}/look", { path: { map }, query: { viewer }, body: undefined }));
}

/** @param {Record<string, boolean | number | string>} changes */
export async function setParameters(changes) {
  const map = openMapId.value;
  if (!map) return null;
  const answer = await told(patch("/api/maps/{map}/parameters", { path: { map }, body: { changes } }));
  if (answer && map === openMapId.value) parameters.value = answer;
  return answer;
}

/** @typedef {Omit<Schemas["Decision"], "author" | "preview">} Decision */

/** One at a time: the next is made when it is known what the last one did. @param {Decision} decision */
export async function decide(decision) {
  const map = openMapId.value;
  if (!map || deciding.value) return null;
  deciding.value = true;
  const body = { ...decision, author: author.value.trim(), preview: false };
  const answer = await told(post("/api/maps/{map}/decisions", { path: { map }, body }));
  deciding.value = false;
  if (!answer || map !== openMapId.value) return null;
  lastDecision.value = { map, made: answer };
  graphRevision.value += 1;
  void loadInfo();
  return answer;
}

/**
 * Something that can be asked for twice: what it would do, and then to do it.
 * @typedef {object} Ask
 * @property {(signal: AbortSignal) => Promise<Schemas["DecisionResult"]>} foresee
 * @property {() => Promise<Schemas["DecisionResult"] | null>} carryOut
 */

/** @param {Decision} decision @returns {Ask} */
export function decisionAsk(decision) {
  const map = /** @type {string} */ (openMapId.value);
  return {
    foresee: (signal) => post("/api/maps/{map}/decisions", { path: { map }, body: { ...decision, author: "", preview: true }, signal }),
    carryOut: () => decide(decision),
  };
}

/**
 * An edit of many nodes or links, of a prior, or of all poses.
 * @param {(path: {map: string}, body: {author: string, preview: boolean}, signal?: AbortSignal) => Promise<Schemas["DecisionResult"]>} send
 * @returns {Ask}
 */
function editAsk(send) {
  const map = /** @type {string} */ (openMapId.value);
  return {
    foresee: (signal) => send({ map }, { author: "", preview: true }, signal),
    carryOut: () => told(alone(map, send({ map }, { author: author.value.trim(), preview: false }), (made) => made)),
  };
}

/** Take nodes out of the map. @param {number[]} nodes */
export const dropAsk = (nodes) => editAsk((path, body, signal) => post("/api/maps/{map}/nodes/drop", { path, body: { nodes, ...body }, signal }));

/** Give nodes a label, numbered where they are several; empty takes theirs away. @param {number[]} nodes @param {string} label */
export const labelAsk = (nodes, label) => editAsk((path, body, signal) => post("/api/maps/{map}/nodes/label", { path, body: { nodes, label, ...body }, signal }));

/** Other covariances for many links. @param {Omit<Schemas["Covariances"], "author" | "preview">} wanted */
export const covarianceAsk = (wanted) => editAsk((path, body, signal) => post("/api/maps/{map}/links/covariances", { path, body: { ...wanted, ...body }, signal }));

/** A node's prior; null takes it away. @param {number} id @param {{transform: number[] | null, sigmas: number[] | null, count: boolean}} prior */
export const priorAsk = (id, prior) => editAsk(({ map }, body, signal) => post("/api/maps/{map}/nodes/{node_id}/prior", { path: { map, node_id: id }, body: { ...prior, ...body }, signal }));

/** Make the poses of an optimisation those of the map. @param {Omit<Schemas["KeepPoses"], "author" | "preview">} wanted */
export const keepAsk = (wanted) => editAsk((path, body, signal) => post("/api/maps/{map}/poses/optimise", { path, body: { ...wanted, ...body }, signal }));

/** Turn the whole map as it is. @param {Omit<Schemas["TurnMap"], "author" | "preview">} wanted */
export const turnAsk = (wanted) => editAsk((path, body, signal) => post("/api/maps/{map}/poses/turn", { path, body: { ...wanted, ...body }, signal }));

/**
 * A decision that has its own place; its answer is the last decision then.
 * @template {Schemas["DecisionResult"] | Schemas["LinkEditResult"]} T
 * @param {string} map
 * @param {Promise<T>} work
 * @param {(answer: T) => Schemas["DecisionResult"] | null} decisionOf
 */
async function alone(map, work, decisionOf) {
  deciding.value = true;
  try {
    const answer = await work;
    const made = decisionOf(answer);
    if (made && map === openMapId.value) {
      lastDecision.value = { map, made };
      graphRevision.value += 1;
      void loadInfo();
    }
    return answer;
  } finally {
    deciding.value = false;
  }
}

/**
 * A link by hand, or what it would do; a refusal is an answer, too.
 * @param {Schemas["LinkEdit"]} edit without its author
 * @returns {Promise<Schemas["LinkEditResult"] | {error: string}>}
 */
export async function editLink(edit) {
  const map = openMapId.value;
  if (!map) return { error: "no map is open" };
  const work = post("/api/maps/{map}/links", { path: { map }, body: { ...edit, author: author.value.trim() } });
  try {
    return edit.preview ? await work : await alone(map, work, (answer) => answer.decision);
  } catch (error) {
    return { error: /** @type {Error} */ (error).message };
  }
}

/** Give a node a label; empty takes it away. @param {number} id @param {string} label */
export async function labelNode(id, label) {
  const map = openMapId.value;
  if (!map) return null;
  const body = { label, author: author.value.trim() };
  return told(alone(map, post("/api/maps/{map}/nodes/{node_id}/label", { path: { map, node_id: id }, body }), (made) => made));
}
