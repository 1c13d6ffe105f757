// Where a bare address leads: to the run under way, to the only map there is, else to the list.
import { effect } from "@preact/signals";
import { go, isFresh } from "./router.js";
import { maps, session } from "./store.js";

export function startLanding() {
  if (!isFresh()) return;
  const stop = effect(() => {
    if (!isFresh()) return queueMicrotask(() => stop());
    const running = session.value?.map;
    const only = maps.value?.length === 1 ? maps.value[0].id : null;
    const map = running ?? only;
    if (map) queueMicrotask(() => isFresh() && go({ map, view: "loops" }, { replace: true }));
    return undefined;
  });
}
