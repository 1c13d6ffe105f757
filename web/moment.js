// Going through the updates of the open map: one of them, or now; by steps, by events, or played.
import { computed, effect, signal, untracked } from "@preact/signals";
import { setScene } from "./actions.js";
import { get, whenQuiet } from "./api.js";
import { openings } from "./events.js";
import { latest } from "./latest.js";
import { remembered } from "./prefs.js";
import { keepMoment, moment, openMapId } from "./router.js";
import { columns, graphRevision, scene } from "./store.js";

/** @typedef {import("./types/http").Schemas["TimelineUpdates"]} Updates */
/** @typedef {import("./types/http").Schemas["TimelineEvent"]} TimelineEvent */
/** @typedef {TimelineEvent["kind"]} EventKind */

/** Steps of playing; a pause between two sessions is no longer than the longest gap. */
const TICK_MS = 60;
const LONGEST_GAP_S = 2;
const SETTLED_MS = 400;
const GROWTH_MS = 1500;

export const SPEEDS = [1, 4, 16];
/** @type {[EventKind, string, string][]} kind, label, colour of tokens.css */
export const KINDS = [
  ["loop", "Loop accepted", "loop"],
  ["refused", "Loop refused", "ink-2"],
  ["lost", "Lost", "bad"],
  ["transfer", "Transfer", "ltm"],
  ["retrieval", "Retrieval", "wm"],
  ["session", "Session", "accent"],
];

/** @type {import("@preact/signals").Signal<Updates | null>} */
export const timeline = signal(null);
/** @type {import("@preact/signals").Signal<Error | null>} */
export const timelineError = signal(null);
export const playing = signal(false);
export const speed = remembered("timeline-speed", 4);
/** The kind of event that one jumps to; empty for all. */
export const kind = remembered("timeline-kind", "");

/** Row of the update that is shown; the number of updates for now. */
export const row = computed(() => {
  const ids = timeline.value?.ids ?? [];
  return moment.value === null ? ids.length : Math.max(0, after(ids, moment.value) - 1);
});

/** The events that one jumps to. */
export const events = computed(() => (timeline.value?.events ?? []).filter((one) => !kind.value || one.kind === kind.value));

/** Number of the ascending values that are not above a limit. @param {number[]} values @param {number} limit */
export function after(values, limit) {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] <= limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

export function startMoment() {
  effect(() => void (openMapId.value, untracked(forget)));
  effect(() => void (openings.value, columns.value?.revision.value, graphRevision.value, untracked(follow)));
  effect(show);
}

/** @type {ReturnType<typeof setTimeout> | undefined} */
let growing;
/** The answer that is on its way, and the state of the graph for which it was asked. */
let loading = Promise.resolve();
let loaded = "";
/** @type {ReturnType<typeof setTimeout> | undefined} */
let settling;
/** @type {ReturnType<typeof setInterval> | undefined} */
let ticking;

function forget() {
  pause();
  asked = undefined;
  timeline.value = null;
  timelineError.value = null;
  loading = load();
}

/** A map that grows is asked for its updates now and then, a large one more rarely. */
function follow() {
  growing ??= setTimeout(async () => {
    await loading;
    growing = undefined;
    const known = timeline.value;
    if (known && loaded === graphState() && known.ids.at(-1) === columns.value?.ids.at(-1)) return;
    loading = load();
  }, Math.max(GROWTH_MS, timeline.value?.ids.length ?? 0));
}

/** What a timeline was made of, but for new updates. */
function graphState() {
  return `${openings.value} ${graphRevision.value}`;
}

export async function load() {
  const map = openMapId.value;
  if (!map) return;
  // A large map's takes long to work out: what the view shows goes before.
  if (!timeline.value) await whenQuiet();
  if (map !== openMapId.value) return;
  loaded = graphState();
  try {
    const found = await get("/api/maps/{map}/timeline", { path: { map } });
    if (map === openMapId.value) [timeline.value, timelineError.value] = [found, null];
  } catch (error) {
    if (map === openMapId.value) timelineError.value = /** @type {Error} */ (error);
  }
}

const send = latest((/** @type {number | null} */ at) => setScene({ at }));
/** The moment that this window asked the 3D view for; undefined before it did. @type {number | null | undefined} */
let asked;

/**
 * The 3D view follows the page, not the reverse. A refusal is told, and not tried again before something changes.
 */
function show() {
  const [now, at] = [scene.value, moment.value];
  if (!now || asked === at) return;
  const first = asked === undefined;
  asked = at;
  // Later the answer to the question before may still be on its way: what the view shows now tells nothing.
  if (!first || now.at !== at) untracked(() => void send(at));
}

/** Show the map after the update of a node, or as it is now. @param {number | null} at */
export function goTo(at) {
  moment.value = at;
  // Browsers refuse an address that changes many times a second.
  clearTimeout(settling);
  settling = setTimeout(() => {
    settling = undefined;
    keepMoment();
  }, SETTLED_MS);
}

/** @param {number} index of the updates; one behind the last is now */
export function goToRow(index) {
  const ids = timeline.value?.ids ?? [];
  goTo(index >= ids.length ? null : (ids[Math.max(0, index)] ?? null));
}

/** @param {number} by updates */
export function step(by) {
  pause();
  goToRow(row.value + by);
}

export function now() {
  pause();
  goTo(null);
}

/** To the next or the previous event of the chosen kind; whether there was one. @param {1 | -1} way */
export function jump(way) {
  pause();
  const from = moment.value ?? Infinity;
  const found = way > 0 ? events.value.find(({ at }) => at > from) : events.value.findLast(({ at }) => at < from);
  if (found) goTo(found.at);
  return Boolean(found);
}

export function pause() {
  clearInterval(ticking);
  playing.value = false;
}

/** From what is shown on, from the start where that is now. */
export function play() {
  const updates = timeline.value;
  if (!updates?.ids.length) return;
  const times = playTimes(updates.stamps);
  if (row.value >= updates.ids.length - 1) goToRow(0);
  let time = times[row.value];
  let last = performance.now();
  playing.value = true;
  clearInterval(ticking);
  ticking = setInterval(() => {
    const tick = performance.now();
    time += ((tick - last) / 1000) * speed.value;
    last = tick;
    if (time >= times[times.length - 1]) return now();
    const next = after(times, time) - 1;
    if (next !== row.value) goToRow(next);
    return undefined;
  }, TICK_MS);
}

export function togglePlay() {
  if (playing.value) pause();
  else play();
}

/** Seconds of each update from the first, long gaps cut short. @param {number[]} stamps */
export function playTimes(stamps) {
  let time = 0;
  return stamps.map((stamp, index) => {
    if (index > 0) time += Math.min(LONGEST_GAP_S, Math.max(0, stamp - stamps[index - 1]));
    return time;
  });
}
