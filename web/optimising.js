// The optimisation that is tried out: how, what came of it, and the step that the 3D view shows.
import { effect, signal } from "@preact/signals";
import { setScene } from "./actions.js";
import { post } from "./api.js";
import { latest } from "./latest.js";
import { openMapId } from "./router.js";
import { graphRevision, scene } from "./store.js";

/** @typedef {import("./types/http").Schemas["OptimiseAsk"]} Ask */
/** @typedef {import("./types/http").Schemas["Optimised"]} Optimised */

/** @type {Required<Ask>} */
const PLAIN = { root: null, without: [], solver: null, kernel: null, start: "odometry", align: false };

export class Optimising {
  /** @param {string} map */
  constructor(map) {
    this.map = map;
    /** @type {import("@preact/signals").Signal<Required<Ask>>} */
    this.ask = signal(PLAIN);
    /** @type {import("@preact/signals").Signal<Optimised | null>} */
    this.found = signal(null);
    /** @type {import("@preact/signals").Signal<Error | null>} */
    this.error = signal(null);
    /** Of the map, when it was found. */
    this.revision = 0;
    this.busy = signal(false);
    this.step = signal(0);
    this.show = latest((/** @type {number} */ step) => setScene({ optimised: { ask: this.ask.value, step } }));
  }

  /** Ask otherwise; the answer to the last question is about something else then. @param {Partial<Ask>} change */
  change(change) {
    this.ask.value = { ...this.ask.value, ...change };
    this.clear();
  }

  async run() {
    if (this.busy.value) return;
    this.busy.value = true;
    const [ask, revision] = [this.ask.value, graphRevision.peek()];
    try {
      const found = await post("/api/maps/{map}/what-if/optimise", { path: { map: this.map }, body: ask });
      if (ask === this.ask.value && this.map === openMapId.value) {
        this.revision = revision;
        [this.found.value, this.error.value] = [found, null];
        this.go(found.steps.length - 1);
      }
    } catch (error) {
      this.error.value = /** @type {Error} */ (error);
    }
    this.busy.value = false;
  }

  /** @param {number} step */
  go(step) {
    this.step.value = step;
    void this.show(step);
  }

  clear() {
    [this.found.value, this.error.value] = [null, null];
    if (scene.value?.optimised && this.map === openMapId.value) void setScene({ optimised: null });
  }
}

/** @type {Optimising | null} */
let open = null;

/** That of the open map, which stays while views come and go. @param {string} map */
export function optimisingOf(map) {
  if (open?.map !== map) open = new Optimising(map);
  return open;
}

/** It goes with its map. */
export function startOptimising() {
  effect(() => void (openMapId.value !== open?.map && (open = null)));
}
