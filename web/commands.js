// All that the command palette can find.
import { command, say, setScene } from "./actions.js";
import * as text from "./format.js";
import { KINDS, goTo, jump, kind, now, pause, timeline, togglePlay } from "./moment.js";
import { FORMATS, saveCloud, saveGrid, savePoses, showExports } from "./parts/exports.js";
import { showHelp } from "./parts/help.js";
import { ENTRIES } from "./parts/rail.js";
import { showTour } from "./parts/tour.js";
import { go, keepMoment, openMapId } from "./router.js";
import { saveScene } from "./scene_picture.js";
import { maps, parameters, scene, session } from "./store.js";
import { toggleTheme } from "./theme.js";

/** @typedef {{kind: string, label: string, detail: string, run: () => void}} Command */

const MOST = 40;

/**
 * Commands that hold every word of the query, those that start with it first; ``map: lab`` looks among maps only.
 * @param {string} query
 * @returns {Command[]}
 */
export function findCommands(query) {
  const [, only, rest] = /^\s*(?:([a-z]+):)?(.*)$/.exec(query.toLowerCase()) ?? ["", undefined, ""];
  const words = rest.split(/\s+/).filter(Boolean);
  const whole = words.join(" ");
  const rank = (/** @type {Command} */ one) => (one.label.toLowerCase().startsWith(whole) ? 0 : 1);
  const matching = everything().filter(({ kind, label, detail }) => {
    if (only && kind !== only) return false;
    const all = `${kind} ${label} ${detail}`.toLowerCase();
    return words.every((word) => all.includes(word));
  });
  return [...byNumber(query), ...matching.sort((a, b) => rank(a) - rank(b))].slice(0, MOST);
}

/** @param {string} query a node's id or a pair of them @returns {Command[]} */
function byNumber(query) {
  const ids = /^\s*(\d+)(?:\s*(?:-|→|to)\s*(\d+))?\s*$/.exec(query);
  if (!ids || !openMapId.value) return [];
  const [, one, other] = ids;
  const at = timeline.value?.ids.includes(Number(one)) ? [{ kind: "time", label: `Moment of node ${one}`, detail: "timeline", run: () => (pause(), goTo(Number(one))) }] : [];
  if (other) return [{ kind: "link", label: `Link ${one} → ${other}`, detail: "", run: () => go({ view: "loops", key: `${one}-${other}` }) }];
  return [{ kind: "node", label: `Node ${one}`, detail: "", run: () => go({ view: "nodes", key: one }) }, ...at];
}

/** @returns {Command[]} */
function everything() {
  return [...viewCommands(), ...runCommands(), ...timelineCommands(), ...layerCommands(), ...mapCommands(), ...parameterCommands(), ...exportCommands(), ...pageCommands()];
}

/** @returns {Command[]} */
function viewCommands() {
  return ENTRIES.filter(({ view }) => openMapId.value || view === "maps").map(({ view, label, keys }) => ({
    kind: "view",
    label,
    detail: keys,
    run: () => go({ view }),
  }));
}

/** @returns {Command[]} */
function runCommands() {
  const state = session.value?.state;
  const paused = state === "paused";
  if (state !== "running" && !paused) return [];
  return [
    { kind: "run", label: paused ? "Resume" : "Pause", detail: "Space", run: () => void command(paused ? "resume" : "pause") },
    { kind: "run", label: "Step", detail: ".", run: () => void command("step") },
    { kind: "run", label: "Stop", detail: "", run: () => void command("stop") },
  ];
}

/** @returns {Command[]} */
function timelineCommands() {
  const updates = timeline.value;
  if (!updates?.ids.length) return [];
  const first = updates.ids[0];
  return [
    { kind: "time", label: "Play the map from here", detail: "P", run: togglePlay },
    { kind: "time", label: "Go back to now", detail: "N", run: now },
    { kind: "time", label: "Go to the first update", detail: `node ${first}`, run: () => (pause(), goTo(first)) },
    ...KINDS.filter(([name]) => updates.events.some((one) => one.kind === name)).flatMap(([name, label]) => [
      { kind: "time", label: `Next ${label.toLowerCase()}`, detail: "Shift →", run: () => ((kind.value = name), void jump(1)) },
      { kind: "time", label: `Previous ${label.toLowerCase()}`, detail: "Shift ←", run: () => ((kind.value = name), void jump(-1)) },
    ]),
  ];
}

/** @returns {Command[]} */
function layerCommands() {
  const layers = Object.entries(scene.value?.layers ?? {});
  return layers.map(([layer, on]) => ({
    kind: "layer",
    label: `${on ? "Hide" : "Show"} ${layer}`,
    detail: "3D view",
    run: () => void setScene({ layers: { [layer]: !on } }),
  }));
}

/** @returns {Command[]} */
function mapCommands() {
  return (maps.value ?? []).map(({ id, nodes, loops, live }) => ({
    kind: "map",
    label: id,
    detail: live ? "live" : `${text.plural(nodes, "node")}, ${text.plural(loops, "loop")}`,
    run: () => go({ map: id, view: "loops" }),
  }));
}

/** @returns {Command[]} */
function parameterCommands() {
  return (parameters.value?.parameters ?? []).map(({ name, value, unit }) => ({
    kind: "parameter",
    label: name,
    detail: `${value} ${unit}`.trim(),
    run: () => go({ view: "params", query: { q: name } }),
  }));
}

/** @returns {Command[]} */
function exportCommands() {
  const map = openMapId.value;
  if (!map) return [];
  const one = (/** @type {string} */ label, /** @type {() => unknown} */ run) => ({ kind: "export", label, detail: map, run: () => void run() });
  return [
    one("Save from this map…", showExports),
    ...FORMATS.map(([format, name]) => one(`Export poses as ${name}`, () => savePoses(format))),
    one("Export the floor plan (PGM, YAML)", saveGrid),
    one("Export the cloud (PLY)", saveCloud),
    one("Save the 3D view as PNG", saveScene),
  ];
}

/** @returns {Command[]} */
function pageCommands() {
  return [
    { kind: "page", label: "Change theme", detail: "T", run: toggleTheme },
    { kind: "page", label: "Keyboard shortcuts", detail: "?", run: showHelp },
    { kind: "page", label: "Copy the link to what is shown", detail: "", run: () => void copyLink() },
    ...(openMapId.value ? [{ kind: "page", label: "Hints for the first visit", detail: "", run: showTour }] : []),
  ];
}

async function copyLink() {
  keepMoment();
  try {
    await navigator.clipboard.writeText(location.href);
    say("The link is copied.", "good");
  } catch {
    say("The browser keeps its clipboard to itself; the link is the page's address.");
  }
}
