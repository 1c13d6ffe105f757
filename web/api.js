// The one place that talks HTTP. Paths, parameters and answers are checked against the server's OpenAPI.

/** @typedef {import("./types/http").Schemas} Schemas */
/** @typedef {import("./types/http").Method} Method */
// The typed functions below have checked paths, queries and bodies by the time these get here.
/** @typedef {{path?: any, query?: any, signal?: AbortSignal, body?: unknown}} Loose */

const QUIET_AT_LAST_MS = 3000;

export class ApiError extends Error {
  /** @param {number} status 0 when the server wasn't reached @param {string} code @param {string} message */
  constructor(status, code, message) {
    super(message);
    this.status = status;
    this.code = code;
  }
}

/**
 * @template {import("./types/http").PathOf<"get">} P
 * @param {P} path
 * @param {import("./types/http").Options<P, "get">} options
 * @returns {Promise<import("./types/http").Ok<P, "get">>}
 */
export function get(path, options) {
  return request("get", path, options);
}

/**
 * @template {import("./types/http").PathOf<"post">} P
 * @param {P} path
 * @param {import("./types/http").Options<P, "post"> & {body: import("./types/http").Body<P, "post">}} options
 * @returns {Promise<import("./types/http").Ok<P, "post">>}
 */
export function post(path, options) {
  return request("post", path, options);
}

/**
 * @template {import("./types/http").PathOf<"patch">} P
 * @param {P} path
 * @param {import("./types/http").Options<P, "patch"> & {body: import("./types/http").Body<P, "patch">}} options
 * @returns {Promise<import("./types/http").Ok<P, "patch">>}
 */
export function patch(path, options) {
  return request("patch", path, options);
}

/**
 * Address of something the browser loads itself: an image, the 3D view, an export.
 * @param {...(string | number)} parts
 */
export function address(...parts) {
  return new URL(parts.map((part) => encodeURIComponent(part)).join("/"), document.baseURI).href;
}

/**
 * A file that the server makes; a refusal is an ApiError as everywhere.
 * @param {string} url from address()
 * @param {Record<string, string>} [query]
 */
export async function file(url, query = {}) {
  const asked = new URL(url);
  for (const [name, value] of Object.entries(query)) asked.searchParams.set(name, value);
  const response = await reach(asked, {});
  if (!response.ok) throw await refusal(response);
  return response.blob();
}

/** Requests of the API that are under way. */
let waiting = 0;
/** @type {Set<() => void>} */
const patient = new Set();

/** When nobody waits for an answer, or after a while: for what may come after that which was asked for first. */
export function whenQuiet() {
  return new Promise((/** @type {(value?: undefined) => void} */ resolve) => {
    const go = () => (patient.delete(go), clearTimeout(late), resolve());
    const late = setTimeout(go, QUIET_AT_LAST_MS);
    patient.add(go);
    // What is asked for in the same moment counts as well.
    setTimeout(answered);
  });
}

function answered() {
  if (!waiting) for (const go of [...patient]) go();
}

/**
 * @param {Method} method
 * @param {string} path
 * @param {Loose} options
 * @returns {Promise<any>}
 */
async function request(method, path, options) {
  waiting += 1;
  try {
    return await asked(method, path, options);
  } finally {
    waiting -= 1;
    setTimeout(answered);
  }
}

/**
 * @param {Method} method
 * @param {string} path
 * @param {Loose} options
 * @returns {Promise<any>}
 */
async function asked(method, path, { path: values = {}, query = {}, signal, body }) {
  const filled = path.replace(/\{(\w+)\}/g, (_, name) => encodeURIComponent(String(values[name]))).slice(1);
  const url = new URL(filled, document.baseURI);
  for (const [name, value] of Object.entries(query ?? {})) {
    if (value !== undefined && value !== null) url.searchParams.set(name, String(value));
  }
  const json = body === undefined ? {} : { body: JSON.stringify(body), headers: { "Content-Type": "application/json" } };
  const response = await reach(url, { method: method.toUpperCase(), signal, ...json });
  if (!response.ok) throw await refusal(response);
  return response.status === 204 ? null : response.json();
}

/** @param {URL} url @param {RequestInit} init */
async function reach(url, init) {
  try {
    return await fetch(url, init);
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw new ApiError(0, "server_gone", "The server doesn't answer.");
  }
}

/** @param {Response} response */
async function refusal(response) {
  const fallback = `The server answered ${response.status} ${response.statusText}`.trim();
  const said = await response.json().catch(() => null);
  return new ApiError(response.status, said?.error?.code ?? "http_error", said?.error?.message ?? fallback);
}
