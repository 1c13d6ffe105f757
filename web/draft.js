// What another LoopThr would mean: asked for while the slider moves, shown as ghosts in the 3D view.
import { signal } from "@preact/signals";
import { get } from "./api.js";
import { setScene } from "./actions.js";
import { openMapId } from "./router.js";
import { scene } from "./store.js";

/** @typedef {import("./types/http").Schemas["LoopWhatIf"]} WhatIf */

const AGAIN_MS = 700;

/** @type {import("@preact/signals").Signal<number | null>} the threshold that is tried out; null outside of the what-if */
export const draft = signal(null);
/** @type {import("@preact/signals").Signal<WhatIf | null>} the newest answer, perhaps about the threshold before */
export const foreseen = signal(null);
/** @type {import("@preact/signals").Signal<Error | null>} */
export const foreseeError = signal(null);
/** Most hypotheses that were still being tried since the slider moved. */
export const mostPending = signal(0);

let busy = false;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

/** Ask for the threshold of the draft, and once more when it moved meanwhile; ask again while images are compared. */
export async function foresee() {
  clearTimeout(timer);
  const [map, threshold] = [openMapId.value, draft.value];
  if (busy || threshold === null || !map) return;
  busy = true;
  try {
    const found = await get("/api/maps/{map}/what-if/loops", { path: { map }, query: { loop_thr: threshold, graph: true } });
    if (map === openMapId.value && draft.value !== null) {
      foreseen.value = found;
      foreseeError.value = null;
      mostPending.value = found.pending ? Math.max(mostPending.value, found.pending) : 0;
      await setScene({ what_if: threshold });
    }
  } catch (error) {
    foreseeError.value = /** @type {Error} */ (error);
  }
  busy = false;
  if (draft.value === null) leave();
  else if (draft.value !== threshold) void foresee();
  else if (foreseen.value?.pending) timer = setTimeout(() => void foresee(), AGAIN_MS);
}

/** @param {number} threshold */
export function tryOut(threshold) {
  draft.value = Math.min(1, Math.max(0, Number(threshold.toFixed(3))));
  void foresee();
}

/** No ghosts any more. */
export function leave() {
  clearTimeout(timer);
  draft.value = foreseen.value = foreseeError.value = null;
  mostPending.value = 0;
  if (scene.value?.what_if !== null && scene.value?.what_if !== undefined) void setScene({ what_if: null });
}
