// Keeps the selection of the tables and of the 3D view the same.
import { effect, signal } from "@preact/signals";
import { setScene } from "./actions.js";
import { on } from "./events.js";
import { latest } from "./latest.js";
import { pickNode } from "./pair.js";
import { go, openMapId, route } from "./router.js";
import { selection } from "./store.js";
import { pickEnd } from "./parts/link_tool.js";
import { viewer } from "./viewer.js";

/** @typedef {{kind: "node" | "link", ids: number[]}} Picked */

/** @type {import("@preact/signals").Signal<number | null>} the node of the row under the pointer in a chart */
export const hovered = signal(null);

const mark = latest(setScene);

export function startPicking() {
  on("selection", (value, map) => map === openMapId.value && (!value.viewer || value.viewer === viewer) && show(value));
  let marked = false;
  effect(() => {
    const now = hovered.value === null ? selection.value : { kind: /** @type {const} */ ("node"), id: hovered.value };
    if (now || marked) queueMicrotask(() => void mark(highlight(now)));
    marked = now !== null;
  });
}

/** @param {Picked} picked a click in the 3D view */
function show({ kind, ids }) {
  // The keys of the inspector work at once, without a click into the page.
  if (document.activeElement instanceof HTMLIFrameElement) document.activeElement.blur();
  if (kind === "node" && route.value.view === "loops" && route.value.query.get("tab") === "link") pickEnd(ids[0]);
  else if (kind === "node") pickNode(ids[0]);
  else go({ view: "loops", key: ids.join("-") });
}

/** @param {import("./store.js").Selection | null} now @returns {import("./store.js").Schemas["SceneChange"]} */
function highlight(now) {
  if (!now) return { selected_node: null, selected_link: null };
  if (now.kind === "node") return { selected_node: now.id, selected_link: null };
  return { selected_node: null, selected_link: [now.from, now.to] };
}
