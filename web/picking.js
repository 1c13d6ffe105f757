// Keeps the selection of the tables and of the 3D view the same.
import { effect } from "@preact/signals";
import { setScene } from "./actions.js";
import { on } from "./events.js";
import { go, openMapId, route } from "./router.js";
import { selection } from "./store.js";
import { pickEnd } from "./parts/link_tool.js";

/** @typedef {{kind: "node" | "link", ids: number[]}} Picked */

export function startPicking() {
  on("selection", (value, map) => map === openMapId.value && show(value));
  effect(() => {
    const now = selection.value;
    if (now) queueMicrotask(() => void setScene(highlight(now)));
  });
}

/** @param {Picked} picked a click in the 3D view */
function show({ kind, ids }) {
  // The keys of the inspector work at once, without a click into the page.
  if (document.activeElement instanceof HTMLIFrameElement) document.activeElement.blur();
  if (kind === "node" && route.value.view === "loops" && route.value.query.get("tab") === "link") pickEnd(ids[0]);
  else if (kind === "node") go({ view: "nodes", key: ids[0], query: Object.fromEntries(route.value.query) });
  else go({ view: "loops", key: ids.join("-") });
}

/** @param {import("./store.js").Selection} now */
function highlight(now) {
  if (now.kind === "node") return { selected_node: now.id, selected_link: null };
  return { selected_node: null, selected_link: [now.from, now.to] };
}
