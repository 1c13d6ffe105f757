// The server's stream of changes: one WebSocket, opened again with growing pauses when it breaks.
import { signal } from "@preact/signals";

/** @typedef {{topic: string, map: string | null, value: any}} Message */
/** @typedef {(value: any, map: string | null) => void} Listener */

const FIRST_PAUSE_MS = 500;
const LONGEST_PAUSE_MS = 8000;

/** @type {Map<string, Set<Listener>>} */
const listeners = new Map();
let pauseMs = FIRST_PAUSE_MS;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

/** @type {import("@preact/signals").Signal<"connecting" | "open" | "lost">} */
export const connection = signal("connecting");
/** When the next try starts, in milliseconds since 1970. */
export const nextTry = signal(0);
/** Counts openings of the stream: whoever shows increments fetches what was missed when it changes. */
export const openings = signal(0);

/**
 * @param {string} topic
 * @param {Listener} listener
 * @returns {() => void} stop listening
 */
export function on(topic, listener) {
  const set = listeners.get(topic) ?? new Set();
  listeners.set(topic, set.add(listener));
  return () => set.delete(listener);
}

export function connect() {
  clearTimeout(timer);
  const url = new URL("api/events", document.baseURI);
  url.protocol = url.protocol.replace("http", "ws");
  const socket = new WebSocket(url);
  socket.onopen = () => {
    pauseMs = FIRST_PAUSE_MS;
    connection.value = "open";
    openings.value += 1;
  };
  socket.onmessage = (event) => deliver(JSON.parse(event.data));
  socket.onclose = () => {
    connection.value = "lost";
    nextTry.value = Date.now() + pauseMs;
    timer = setTimeout(connect, pauseMs);
    pauseMs = Math.min(pauseMs * 2, LONGEST_PAUSE_MS);
  };
}

/** @param {Message} message */
function deliver({ topic, map, value }) {
  for (const listener of listeners.get(topic) ?? []) listener(value, map);
}
