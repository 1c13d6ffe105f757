// The slider through the updates of the map, with a mark for all that happened, buttons to go to it, and a list of it.
import { useEffect, useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import * as text from "../format.js";
import { link, moment } from "../router.js";
import { KINDS, SPEEDS, events, goToRow, jump, kind, load, now, pause, playing, row, speed, step, timeline, timelineError, togglePlay } from "../moment.js";
import { Button } from "./button.js";
import { EventList } from "./event_list.js";
import { Icon } from "./icons.js";
import { useWidth } from "./use.js";
import { scene } from "../store.js";
import { color, theme } from "../theme.js";

/** @typedef {import("../moment.js").Updates} Updates */

const HINT = "Nodes, loops, memories, grid and clouds as they were then. What people decided is today's.";
const PLACINGS = {
  then: "poses of then",
  soon: "poses of today",
  now: "poses of today",
};
const SOON = "The graph of then is optimised as soon as you stay at one update.";
const NO_MEMORY = " This file does not say which node was in which memory, so these colours are today's.";

export function TimelineBar() {
  const updates = timeline.value;
  const [listed, setListed] = useState(false);
  if (timelineError.value && !updates) return h(Broken, { error: timelineError.value });
  const empty = !updates?.ids.length;
  return html`<section class="timeline" aria-label="Timeline">
    <div class="timeline-buttons" role="toolbar" aria-label="Go through the updates">
      ${h(Button, { icon: "eventBack", kind: "bare", hint: "Previous event (Shift ←)", disabled: empty, onClick: () => void jump(-1) })}
      ${h(Button, { icon: "stepBack", kind: "bare", hint: "Previous update (←)", disabled: empty, onClick: () => step(-1) })}
      ${h(Button, { icon: playing.value ? "pause" : "play", kind: "bare", hint: playing.value ? "Pause (P)" : "Play (P)", disabled: empty, onClick: togglePlay })}
      ${h(Button, { icon: "step", kind: "bare", hint: "Next update (→)", disabled: empty, onClick: () => step(1) })}
      ${h(Button, { icon: "eventNext", kind: "bare", hint: "Next event (Shift →)", disabled: empty, onClick: () => void jump(1) })}
    </div>
    ${h(Speed, {})}
    <div class="timeline-track">
      ${updates && h(Ticks, { updates })}
      <input
        type="range"
        class="timeline-slider"
        aria-label="Update that is shown"
        aria-valuetext=${caption(updates)}
        min="0"
        max=${updates?.ids.length ?? 0}
        value=${row.value}
        disabled=${empty}
        onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => (pause(), goToRow(Number(currentTarget.value)))}
      />
    </div>
    ${h(Shown, { updates })}
    ${h(Button, { label: "Now", kind: moment.value === null ? "plain" : "accent", hint: "The map as it is now (N)", disabled: moment.value === null, onClick: now })}
    ${h(Button, { icon: "list", kind: "bare", hint: "What happened", pressed: listed, disabled: empty, onClick: () => setListed(!listed) })}
    ${listed && h(EventList, { close: () => setListed(false) })}
  </section>`;
}

/** @param {{error: Error}} props */
function Broken({ error }) {
  return html`<section class="timeline" aria-label="Timeline" role="alert">
    <span class="ink-bad clip grow" title=${error.message}>The timeline didn't arrive: ${error.message}</span>
    ${h(Button, { label: "Try again", onClick: () => void load() })}
  </section>`;
}

function Speed() {
  return html`<label class="chip chip-select" title="How fast it plays">
    <span class="sr-only">Speed</span>
    <select
      value=${speed.value}
      onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => (speed.value = Number(currentTarget.value))}
    >
      ${SPEEDS.map((times) => html`<option key=${times} value=${times}>${times}×</option>`)}
    </select>
  </label>`;
}

/** What is shown, in words. @param {{updates: Updates | null}} props */
function Shown({ updates }) {
  const at = row.value;
  const past = updates && moment.value !== null;
  if (!past) return html`<output class="timeline-shown quiet">${updates ? `now · ${text.plural(updates.ids.length, "update")}` : ""}</output>`;
  const node = updates.ids[at];
  return html`<output class="timeline-shown" title=${HINT + (updates.memory ? "" : NO_MEMORY)}>
    <a href=${link({ view: "nodes", key: node })}>node ${node}</a>
    <span class="quiet">${text.fixed(updates.stamps[at] - updates.stamps[0], 1)} s</span>
    ${h(Placing, {})}
    ${h(Icon, { name: "info" })}
  </output>`;
}

/** Where the nodes of the 3D view stand. */
function Placing() {
  const now = scene.value;
  if (!now || now.at === null || now.at !== moment.value) return null;
  const why = now.placing === "soon" ? SOON : now.placing_note;
  return html`<span class=${now.placing === "then" ? "quiet" : "ink-warn"} title=${why}>${PLACINGS[now.placing]}</span>`;
}

/** @param {Updates | null} updates */
function caption(updates) {
  return updates && moment.value !== null ? `node ${updates.ids[row.value]}` : "now";
}

/** A line for every event above the slider. @param {{updates: Updates}} props */
function Ticks({ updates }) {
  const canvas = useRef(/** @type {HTMLCanvasElement | null} */ (null));
  const width = useWidth(canvas);
  useEffect(() => void (canvas.current && width && drawTicks(canvas.current, width, updates)), [updates, width, theme.value, kind.value]);
  return html`<canvas ref=${canvas} class="timeline-ticks" aria-hidden="true"></canvas>`;
}

const TICK_HEIGHT = 8;
/** Half of the slider's thumb: its middle does not reach the ends of the track. */
const THUMB_PX = 8;

/** @param {HTMLCanvasElement} canvas @param {number} width @param {Updates} updates */
function drawTicks(canvas, width, updates) {
  const scale = devicePixelRatio;
  [canvas.width, canvas.height] = [Math.round(width * scale), Math.round(TICK_HEIGHT * scale)];
  const ctx = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  ctx.scale(scale, scale);
  const rows = new Map(updates.ids.map((id, index) => [id, index]));
  const step = (width - 2 * THUMB_PX) / Math.max(1, updates.ids.length);
  for (const [name, , token] of KINDS.toReversed()) {
    ctx.fillStyle = color(token);
    for (const event of events.value) {
      const index = event.kind === name ? rows.get(event.at) : undefined;
      if (index !== undefined) ctx.fillRect(THUMB_PX + index * step - 0.75, 0, 1.5, TICK_HEIGHT);
    }
  }
}
