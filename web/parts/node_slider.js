// Through all nodes of the table with a slider: each is shown while it is dragged.
import { useMemo, useState } from "preact/hooks";
import { html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { latest } from "../latest.js";
import { graphRevision } from "../store.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {{order: import("../window.js").NodeOrder, q: string, dropped: boolean}} Shown what the table shows, in which order */

/**
 * @typedef {object} SliderProps
 * @property {string} map
 * @property {number} id of the node that is shown
 * @property {string} label
 * @property {Shown} shown
 * @property {(id: number) => void} onPick
 */

/** @param {SliderProps} props */
export function NodeSlider({ map, id, label, shown, onPick }) {
  const ask = (/** @type {{offset: number, find?: number}} */ where, /** @type {AbortSignal} */ signal) =>
    get("/api/maps/{map}/nodes", { path: { map }, query: { ...shown, ...where, limit: 1 }, signal });
  const { data, reload } = useFetched((signal) => ask({ offset: 0, find: id }, signal), [map, id, shown.order, shown.q, shown.dropped]);
  useChanged(graphRevision, reload);
  const [dragged, setDragged] = useState(/** @type {number | null} */ (null));
  const pick = useMemo(
    () =>
      latest(async (/** @type {number} */ row) => {
        const found = await ask({ offset: row }, new AbortController().signal).catch(() => null);
        if (found?.nodes.length) onPick(found.nodes[0].id);
      }),
    [map, shown.order, shown.q, shown.dropped],
  );
  const total = data.value?.total ?? 0;
  const at = dragged ?? data.value?.at ?? 0;
  return html`<label class="node-slider" title=${data.value?.at == null ? "Not among the nodes of the table" : `${text.whole(at + 1)} of ${text.whole(total)}`}>
    <input
      type="range"
      min="0"
      max=${Math.max(1, total - 1)}
      value=${at}
      disabled=${total < 2}
      aria-label=${label}
      onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => (setDragged(Number(currentTarget.value)), void pick(Number(currentTarget.value)))}
      onChange=${() => setDragged(null)}
    />
  </label>`;
}

/**
 * The node so many rows on; null at the ends, and where the node is not in the table.
 * @param {string} map
 * @param {number} id
 * @param {number} by
 * @param {Shown} shown
 */
export async function nodeBeside(map, id, by, shown) {
  const { at, total } = await get("/api/maps/{map}/nodes", { path: { map }, query: { ...shown, offset: 0, limit: 1, find: id } });
  const row = (at ?? -1) + by;
  if (row < 0 || row >= total) return null;
  const { nodes } = await get("/api/maps/{map}/nodes", { path: { map }, query: { ...shown, offset: row, limit: 1 } });
  return nodes[0]?.id ?? null;
}
