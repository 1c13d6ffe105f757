// What GNC says of the loops of the open map: worked out on request, shown as one more column of the queue.
import { effect, signal, untracked } from "@preact/signals";
import { get, post } from "./api.js";
import { say } from "./actions.js";
import { on } from "./events.js";
import { openMapId } from "./router.js";
import { graphRevision } from "./store.js";

/** @typedef {import("./types/http").Schemas["LoopWeights"]} LoopWeights */

/** @type {import("@preact/signals").Signal<LoopWeights | null>} */
export const weights = signal(null);

/** Weight of a loop, null where GNC wasn't asked. @param {{from: number, to: number}} loop */
export function weightOf({ from, to }) {
  return weights.value?.weights[`${Math.min(from, to)}-${Math.max(from, to)}`] ?? null;
}

export const weigh = () => ask((map) => post("/api/maps/{map}/loop-weights", { path: { map }, body: undefined }));
const load = () => ask((map) => get("/api/maps/{map}/loop-weights", { path: { map } }));

/** @param {(map: string) => Promise<LoopWeights>} request */
async function ask(request) {
  const map = openMapId.value;
  if (!map) return;
  try {
    const found = await request(map);
    if (map === openMapId.value) weights.value = found;
  } catch (error) {
    say(/** @type {Error} */ (error).message);
  }
}

export function startWeights() {
  effect(() => {
    void openMapId.value;
    untracked(() => {
      weights.value = null;
      void load();
    });
  });
  on("weights", (_, map) => void (map === openMapId.value && load()));
  // A result is of the graph as it was: whether that is still so, the server knows.
  effect(() => void (graphRevision.value && untracked(() => weights.value?.state === "done" && !weights.value.stale && load())));
}
