// What this browser remembers between visits: sizes, theme, choices of columns and charts.
import { effect, signal } from "@preact/signals";

const PREFIX = "slamdeck.";

/**
 * A signal that is kept in localStorage.
 * @template T
 * @param {string} name
 * @param {T} initial used until something valid was stored
 * @returns {import("@preact/signals").Signal<T>}
 */
export function remembered(name, initial) {
  const kept = signal(read(name, initial));
  effect(() => write(name, kept.value));
  return kept;
}

/**
 * @template T
 * @param {string} name
 * @param {T} initial
 * @returns {T}
 */
function read(name, initial) {
  try {
    const value = JSON.parse(localStorage.getItem(PREFIX + name) ?? "null");
    return value !== null && typeof value === typeof initial ? value : initial;
  } catch {
    return initial; // storage is blocked, or somebody else's text is in it
  }
}

/** @param {string} name @param {unknown} value */
function write(name, value) {
  try {
    localStorage.setItem(PREFIX + name, JSON.stringify(value));
  } catch {
    // Storage is blocked or full: the choice then lasts as long as the page.
  }
}
