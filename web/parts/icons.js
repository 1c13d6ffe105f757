// The page's own icons: 24x24 strokes.
import { html } from "../html.js";

const PATHS = {
  maps: "M3 6.5 9 4l6 2.5L21 4v13.5L15 20l-6-2.5L3 20zM9 4v13.5M15 6.5V20",
  nodes: "M6 18 11 7l7 8M8 18h8M6 16a2 2 0 1 0 0 4 2 2 0 0 0 0-4zM11 4a2 2 0 1 0 0 4 2 2 0 0 0 0-4zM18 15a2 2 0 1 0 0 4 2 2 0 0 0 0-4z",
  loops: "M20 12a8 8 0 0 1-14.2 5M4 12A8 8 0 0 1 18.2 7M18.5 3v4.5H14M5.5 21v-4.5H10",
  params: "M4 8h9M17 8h3M15 6v4M4 16h3M11 16h9M9 14v4",
  graph: "M5 6.5h6M13.5 8l-6 8.5M13.5 8 17 15.5M8 18h8M5.5 4.5a2 2 0 1 0 0 4 2 2 0 0 0 0-4zM13 4.5a2 2 0 1 0 0 4 2 2 0 0 0 0-4zM6 16a2 2 0 1 0 0 4 2 2 0 0 0 0-4zM18 15.5a2 2 0 1 0 0 4 2 2 0 0 0 0-4z",
  stats: "M4 4v16h16M7.5 15l3.5-4 3 2.5L19 7",
  pause: "M9 6v12M15 6v12",
  play: "M8 5.5v13l10-6.5z",
  step: "M6 5.5v13l8.5-6.5zM18 6v12",
  stepBack: "M18 5.5v13L9.5 12zM6 6v12",
  eventNext: "m5 6 6 6-6 6M11 6l6 6-6 6M20 6v12",
  eventBack: "m19 6-6 6 6 6M13 6l-6 6 6 6M4 6v12",
  list: "M8.5 6.5H20M8.5 12H20M8.5 17.5H20M4 6.5h.5M4 12h.5M4 17.5h.5",
  stop: "M7 7h10v10H7z",
  search: "M11 5a6 6 0 1 0 0 12 6 6 0 0 0 0-12zM15.5 15.5 20 20",
  dark: "M20 14.5A8 8 0 1 1 9.5 4a6.5 6.5 0 0 0 10.5 10.5z",
  light: "M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8zM12 3v2M12 19v2M3 12h2M19 12h2M5.6 5.6 7 7M17 17l1.4 1.4M5.6 18.4 7 17M17 7l1.4-1.4",
  down: "m7 10 5 5 5-5",
  up: "m7 14 5-5 5 5",
  close: "M6 6l12 12M18 6 6 18",
  check: "m5 12.5 4.5 4.5L19 7.5",
  undo: "M9 7 4.5 11.5 9 16M5 11.5h8.5a5 5 0 0 1 0 10H11",
  redo: "m15 7 4.5 4.5L15 16M19 11.5h-8.5a5 5 0 0 0 0 10H13",
  expand: "M9 4H4v5M15 4h5v5M9 20H4v-5M15 20h5v-5",
  image: "M4 5h16v14H4zM4 16l5-5 4 4 2.5-2.5L20 17M15.5 8.5a1 1 0 1 0 0 2 1 1 0 0 0 0-2z",
  warn: "M12 4 2.8 19.5h18.4zM12 10v4.5M12 17v.2",
  info: "M12 3.5a8.5 8.5 0 1 0 0 17 8.5 8.5 0 0 0 0-17zM12 11v5.5M12 7.5v.2",
  offline: "M4 4l16 16M8.5 15.5a5 5 0 0 1 7 0M5 12a10 10 0 0 1 3.6-2.4M12 8.5A10 10 0 0 1 19 12M12 19v.2",
  plus: "M12 5v14M5 12h14",
  export: "M12 4v11M7.5 10.5 12 15l4.5-4.5M5 19.5h14",
  reset: "M4 12a8 8 0 1 0 2.6-5.9M4 4.5V9h4.5",
};

/** @typedef {keyof typeof PATHS} IconName */

/** @param {{name: IconName}} props */
export function Icon({ name }) {
  return html`<svg class="icon" viewBox="0 0 24 24" aria-hidden="true"><path d=${PATHS[name]} /></svg>`;
}
