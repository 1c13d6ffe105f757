// The keyboard: keys of the page, and those that a view adds while it is on screen.
import { useLayoutEffect, useRef } from "preact/hooks";
import { command } from "./actions.js";
import { jump, now, step, togglePlay } from "./moment.js";
import { showHelp } from "./parts/help.js";
import { ENTRIES } from "./parts/rail.js";
import { openPalette } from "./parts/palette.js";
import { go, openMapId } from "./router.js";
import { session } from "./store.js";
import { toggleTheme } from "./theme.js";

/** @typedef {Record<string, () => void>} KeyMap */

/** @type {Set<{current: KeyMap}>} */
const viewKeys = new Set();

/**
 * Keys of a view, as long as it is mounted.
 * @param {KeyMap} map
 */
export function useKeys(map) {
  const latest = useRef(map);
  latest.current = map;
  // Before the view is painted: a key pressed as soon as it is seen must not get lost.
  useLayoutEffect(() => {
    viewKeys.add(latest);
    return () => void viewKeys.delete(latest);
  }, []);
}

export function startKeys() {
  addEventListener("keydown", (event) => {
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "k") return act(event, () => openPalette());
    if (event.ctrlKey || event.metaKey || event.altKey || isTaken(event)) return undefined;
    return act(event, find(event.shiftKey && event.key.startsWith("Arrow") ? `Shift+${event.key}` : event.key));
  });
}

/** @param {KeyboardEvent} event @param {(() => void) | undefined} action */
function act(event, action) {
  if (!action) return;
  event.preventDefault();
  action();
}

/** @param {string} key @returns {(() => void) | undefined} */
function find(key) {
  for (const { current } of viewKeys) {
    const action = current[key] ?? current[key.toLowerCase()];
    if (action) return action;
  }
  const entry = ENTRIES.find(({ keys }) => keys === key);
  if (entry && (openMapId.value || entry.view === "maps")) return () => go({ view: entry.view });
  return pageKeys()[key.toLowerCase()];
}

/** @returns {KeyMap} */
function pageKeys() {
  const state = session.value?.state;
  const runs = state === "running" || state === "paused";
  return {
    t: toggleTheme,
    ...(openMapId.value && {
      arrowleft: () => step(-1),
      arrowright: () => step(1),
      "shift+arrowleft": () => void jump(-1),
      "shift+arrowright": () => void jump(1),
      p: togglePlay,
      n: now,
    }),
    "?": showHelp,
    ...(runs && { " ": () => void command(state === "paused" ? "resume" : "pause"), ".": () => void command("step") }),
  };
}

/** Whether the key belongs to an open dialog, a field or a control that has the focus. @param {KeyboardEvent} event */
function isTaken({ target, key }) {
  if (document.querySelector("dialog[open]")) return true;
  if (!(target instanceof HTMLElement)) return false;
  if (target.closest("[role=separator], [type=range]")) return key === " " || key === "Enter" || key.startsWith("Arrow");
  if (target.closest("button, a, summary, [type=checkbox]")) return key === " " || key === "Enter";
  return ["INPUT", "SELECT", "TEXTAREA"].includes(target.tagName);
}
