// Three hints for the first visit: each points at a part of the page; put away once, they don't come back by themselves.
import { signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { remembered } from "../prefs.js";
import { openMapId } from "../router.js";
import { Button } from "./button.js";

/** @type {{part: string, title: string, text: string}[]} */
const STEPS = [
  {
    part: ".scene",
    title: "The map in 3D",
    text: "Drag to turn, scroll to zoom. A click on a node or on an arc opens it at the right; the buttons above choose what is drawn.",
  },
  {
    part: ".timeline",
    title: "How it came about",
    text: "Pull the slider, or press ← and →, to see the map as it was after each update. The marks are loops, losses and transfers.",
  },
  {
    part: ".rail",
    title: "Judge and tune",
    text: "Loops lists every loop, the doubtful first: A approves, R rejects. Ctrl K finds everything else, ? shows all keys.",
  },
];
const GAP_PX = 12;
const CARD = { width: 320, height: 164 };

const seen = remembered("tour-seen", false);
const step = signal(0);

/** Show it again. */
export function showTour() {
  step.value = 0;
  seen.value = false;
}

export function Tour() {
  return seen.value || !openMapId.value ? null : h(Hint, { key: step.value, index: step.value });
}

/** @param {{index: number, key?: unknown}} props */
function Hint({ index }) {
  const { part, title, text } = STEPS[index];
  const place = usePlace(part);
  const last = index === STEPS.length - 1;
  const close = () => void (seen.value = true);
  useEscape(close);
  if (!place) return null;
  return html`<div class="tour-ring" style=${inPixels(place)} aria-hidden="true"></div>
    <section class="tour" role="dialog" aria-label=${`Hint ${index + 1} of ${STEPS.length}: ${title}`} style=${inPixels(beside(place))}>
      <header><b class="grow">${title}</b>${h(Button, { icon: "close", kind: "bare", hint: "Put the hints away", onClick: close })}</header>
      <p>${text}</p>
      <footer>
        <span class="quiet small grow">${index + 1} of ${STEPS.length}</span>
        ${index > 0 && h(Button, { label: "Back", onClick: () => (step.value -= 1) })}
        ${h(Button, { label: last ? "Done" : "Next", kind: "accent", onClick: last ? close : () => (step.value += 1) })}
      </footer>
    </section>`;
}

/** Escape closes what does not take the focus, unless a dialog is open. @param {() => void} close */
function useEscape(close) {
  useEffect(() => {
    const onKey = (/** @type {KeyboardEvent} */ { key }) => key === "Escape" && !document.querySelector("dialog[open]") && close();
    addEventListener("keydown", onKey);
    return () => removeEventListener("keydown", onKey);
  }, []);
}

/** @typedef {{left: number, top: number, width: number, height: number}} Place */

/** Where a part of the page is, also after the window changed. @param {string} part @returns {Place | null} */
function usePlace(part) {
  const [place, setPlace] = useState(/** @type {Place | null} */ (null));
  useEffect(() => {
    const target = document.querySelector(part);
    if (!target) return undefined;
    const observer = new ResizeObserver(() => setPlace(target.getBoundingClientRect()));
    observer.observe(target);
    observer.observe(document.body);
    return () => observer.disconnect();
  }, [part]);
  return place;
}

/** To the right of a column, above a row, within a large part; always on screen. @param {Place} place @returns {Place} */
function beside({ left, top, width, height }) {
  const column = width < CARD.width / 2;
  const row = height < CARD.height;
  const wanted = {
    left: column ? left + width + GAP_PX : left + GAP_PX,
    top: row ? top - CARD.height - GAP_PX : top + (column ? GAP_PX : 60),
  };
  return {
    ...CARD,
    left: Math.max(GAP_PX, Math.min(innerWidth - CARD.width - GAP_PX, wanted.left)),
    top: Math.max(GAP_PX, Math.min(innerHeight - CARD.height - GAP_PX, wanted.top)),
  };
}

/** @param {Place} place */
function inPixels({ left, top, width, height }) {
  return { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` };
}
