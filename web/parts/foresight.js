// What a threshold would have meant for the updates so far, while its slider moves.
import { html } from "../html.js";
import * as text from "../format.js";
import { columns } from "../store.js";
import { HYPOTHESIS, TIME } from "./strip.js";

/** @type {Record<string, {name: string, says: (above: string, total: string) => string, off: (value: number) => boolean}>} */
const WATCHED = {
  "Rtabmap/LoopThr": {
    name: HYPOTHESIS,
    says: (above, total) => `reached by ${above} of ${total} updates so far`,
    off: () => false,
  },
  "Rtabmap/TimeThr": {
    name: TIME,
    says: (above, total) => `exceeded by ${above} of ${total} updates so far`,
    off: (value) => value <= 0,
  },
};

/** @param {{parameter: string, draft: number, inForce: number}} props */
export function Foresight({ parameter, draft, inForce }) {
  const watched = WATCHED[parameter];
  const data = columns.value;
  if (!watched || !data) return null;
  void data.revision.value;
  const known = data.column(watched.name).filter((value) => value !== null);
  if (!known.length || watched.off(inForce)) return null;
  const above = (/** @type {number} */ limit) => text.whole(known.filter((value) => value >= limit).length);
  const now = html`${text.short(inForce)} was ${watched.says(above(inForce), text.whole(known.length))}`;
  if (draft === inForce || watched.off(draft)) return html`<p class="small foresight">${now}</p>`;
  return html`<p class="small foresight">${now}; <b>${text.short(draft)}</b> would have been by <b>${above(draft)}</b></p>`;
}
