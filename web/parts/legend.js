// What the colours of the 3D view mean, with counts.
import { html } from "../html.js";
import * as text from "../format.js";
import { after } from "../moment.js";
import { moment } from "../router.js";
import { columns, info, scene } from "../store.js";
import { endOf, labelOf, shownScale } from "./colouring.js";

/** @typedef {{token: string, label: string, kind?: "dot" | "line" | "dash"}} Entry */

export const STM = "Memory/Short_time_memory_size/";
export const WM = "Memory/Working_memory_size/";
export const LTM = "Memory/Long_term_memory_size/";

/** Type as it is stored, colour, label, class. */
const LOOPS = /** @type {[string, string, string, import("./link_classes.js").LinkClass][]} */ ([
  ["GlobalClosure", "loop", "loop", "loop"],
  ["LocalSpaceClosure", "near", "proximity", "proximity"],
  ["LocalTimeClosure", "time", "proximity in time", "time"],
  ["UserClosure", "hand", "by hand", "user"],
]);

export function Legend() {
  const now = scene.value;
  if (!now) return null;
  /** @type {Entry[]} */
  const frontiers = now.layers.grid && now.grid_as === "frontiers" ? [{ token: "to", label: "frontier" }] : [];
  const entries = [...(now.layers.graph ? graphEntries(now) : []), ...pathEntries(now.layers), ...frontiers, ...ghostEntries(now)];
  if (!entries.length) return null;
  return html`<ul class="legend" aria-label="Legend">
    ${entries.map(
      ({ token, label, kind = "dot" }) =>
        html`<li key=${label}><i class=${`mark mark-${kind} scene-${token}`} aria-hidden="true"></i>${label}</li>`,
    )}
  </ul>`;
}

/** @param {import("../store.js").Schemas["Scene"]} now @returns {Entry[]} */
function graphEntries({ colour, hidden_links: hidden = [] }) {
  const nodes = colour === "memory" ? memoryEntries() : rampEntries(colour);
  const loops = LOOPS.filter(([, , , kind]) => !hidden.includes(kind)).flatMap(([type, token, label]) => loopEntry(type, token, label));
  const refused = info.value?.refused && !hidden.includes("refused") ? [/** @type {Entry} */ ({ token: "refused", label: "refused", kind: "dash" })] : [];
  return [...nodes, ...loops, ...refused];
}

/** @param {string} type @param {string} token @param {string} label @returns {Entry[]} */
function loopEntry(type, token, label) {
  const count = info.value?.links[type] ?? 0;
  // How many there were then is told by the charts.
  return count ? [{ token, label: moment.value === null ? `${label} ${text.whole(count)}` : label, kind: "line" }] : [];
}

/** Nodes of short-term, working and long-term memory: of the last update, and of a map that nobody makes as it is. */
function memories() {
  const now = info.value;
  if (now && !now.live && moment.value === null) return ["stm", "wm", "ltm"].map((tier) => now.memory[tier] ?? 0);
  const [stm, wm] = [shown(STM) ?? 0, shown(WM) ?? 0];
  return [stm, wm, shown(LTM) ?? Math.max(0, (now?.nodes ?? 0) - stm - wm)];
}

/** @returns {Entry[]} */
function memoryEntries() {
  void columns.value?.revision.value;
  const [stm, wm, ltm] = memories();
  return [
    { token: "stm", label: `STM ${text.whole(stm)}` },
    { token: "wm", label: `WM ${text.whole(wm)}` },
    { token: "ltm", label: `LTM ${text.whole(ltm)}` },
  ];
}

/** The value of the moment that is shown, else the newest. @param {string} name */
function shown(name) {
  const data = columns.value;
  if (!data || moment.value === null) return data?.last(name) ?? null;
  return data.column(name)[after(data.ids, moment.value) - 1] ?? null;
}

/** @param {string} colour @returns {Entry[]} */
function rampEntries(colour) {
  const scale = shownScale.value;
  if (scale !== null && scale.name === colour) {
    return [
      { token: "low", label: `${labelOf(colour)} ${endOf(scale, scale.low)}` },
      { token: "high", label: endOf(scale, scale.high) },
      ...(scale.known < (info.value?.nodes ?? 0) ? [/** @type {Entry} */ ({ token: "refused", label: "not known" })] : []),
    ];
  }
  if (colour !== "time" && colour !== "weight" && colour !== "session") return [];
  if (colour === "session") return [{ token: "wm", label: "one colour per session" }];
  return [
    { token: "low", label: colour === "time" ? "oldest" : "lightest" },
    { token: "high", label: colour === "time" ? "newest" : "heaviest" },
  ];
}

/** @param {import("../store.js").Schemas["Scene"]} now @returns {Entry[]} */
function ghostEntries({ layers, what_if: threshold, trial, optimised, at }) {
  const tried = optimised && layers.graph && at === null ? [/** @type {Entry} */ ({ token: "coming", label: "optimised on trial", kind: "dash" })] : [];
  if ((threshold === null && trial === null) || !layers.graph) return tried;
  return [
    ...tried,
    { token: "coming", label: threshold === null ? `by trial ${trial}` : `at LoopThr ${text.short(threshold)}`, kind: "dash" },
    { token: "going", label: "would go", kind: "line" },
  ];
}

/** @param {{odometry: boolean, truth: boolean}} layers @returns {Entry[]} */
function pathEntries({ odometry, truth }) {
  return [
    ...(odometry ? [/** @type {Entry} */ ({ token: "odom", label: "odometry", kind: "dash" })] : []),
    ...(truth ? [/** @type {Entry} */ ({ token: "truth", label: "truth", kind: "line" })] : []),
  ];
}
