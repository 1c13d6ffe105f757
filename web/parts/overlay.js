// Both clouds of a link over each other in the 3D view, as the link says or as the graph has it.
import { useEffect } from "preact/hooks";
import { h, html } from "../html.js";
import { setScene } from "../actions.js";
import { info, scene } from "../store.js";
import { Chip } from "./button.js";

const WAYS = /** @type {["link" | "poses", string, string][]} */ ([
  ["link", "by the link", "The second cloud where the measured transform puts it"],
  ["poses", "by the poses", "Both clouds where the optimised graph has their nodes"],
]);

/** @param {{from: number, to: number, measured: boolean, scans: boolean[]}} props scans: whether each node has points of a scanner */
export function Overlay({ from, to, measured, scans }) {
  const now = scene.value?.overlay ?? null;
  const of = scene.value?.overlay_of ?? "cloud";
  const asked = of === "scan";
  const show = (/** @type {"cloud" | "scan" | "words"} */ what) => void setScene({ overlay_of: what, overlay: now ?? (measured ? "link" : "poses"), selected_link: [from, to] });
  const without = [from, to].filter((_, at) => !scans[at]);
  useEffect(() => () => void (scene.peek()?.overlay && setScene({ overlay: null })), []);
  return html`<div class="picture-bar overlay-bar" role="group" aria-label="Clouds in the 3D view">
    <span class="quiet small">Clouds</span>
    <i class="mark mark-dot scene-from" aria-hidden="true"></i><span class="small">${from}</span>
    <i class="mark mark-dot scene-to" aria-hidden="true"></i><span class="small">${to}</span>
    ${WAYS.map(([how, label, hint]) =>
      h(Chip, {
        key: how,
        label,
        hint: how === "link" && !measured ? "No transform was measured" : hint,
        on: now === how,
        disabled: how === "link" && !measured,
        onChange: (on) => void setScene({ overlay: on ? how : null, selected_link: [from, to] }),
      }),
    )}
    ${info.value?.has_scans &&
    h(Chip, {
      label: "Scans",
      hint: "The points of their scanners in place of those of depth images",
      on: asked,
      onChange: (on) => show(on ? "scan" : "cloud"),
    })}
    ${h(Chip, { label: "Words", hint: "The key points of both that have depth, in place of their clouds", on: of === "words", onChange: (on) => show(on ? "words" : "cloud") })}
    ${asked && now !== null && without.length > 0 && html`<span class="small ink-warn" role="status">${without.length === 2 ? "no scans here" : `no scan of ${without[0]}`}: points of depth images</span>`}
  </div>`;
}
