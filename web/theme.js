// Dark or light: the person's choice, else the system's.
import { computed, effect, signal } from "@preact/signals";
import { remembered } from "./prefs.js";

const system = matchMedia("(prefers-color-scheme: light)");
const systemLight = signal(system.matches);
const choice = remembered("theme", "system");

export const theme = computed(() => {
  if (choice.value === "dark" || choice.value === "light") return choice.value;
  return systemLight.value ? "light" : "dark";
});

export function startTheme() {
  system.addEventListener("change", () => (systemLight.value = system.matches));
  effect(() => {
    document.documentElement.dataset.theme = theme.value;
  });
}

export function toggleTheme() {
  choice.value = theme.value === "dark" ? "light" : "dark";
}

/**
 * The present value of a colour of tokens.css, for canvases.
 * @param {string} token without the two dashes
 */
export function color(token) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${token}`).trim();
}
