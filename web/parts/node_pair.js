// Two nodes beside each other: images, the words that both saw, where they are to each other, what links them.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { useKeys } from "../keys.js";
import { setFirst, setSecond, side, swap } from "../pair.js";
import { pointAt } from "../pointed.js";
import { link } from "../router.js";
import { graphRevision } from "../store.js";
import { Button, Chip } from "./button.js";
import { secondsOf } from "../depth_look.js";
import { DepthLook } from "./depth_bar.js";
import { LinkName } from "./link_name.js";
import { useFeatures } from "./keypoints.js";
import { Lightbox } from "./lightbox.js";
import { SecondPicture, isAligned } from "./node_images.js";
import { nodeFacts } from "./node_facts.js";
import { NodeSlider, nodeBeside } from "./node_slider.js";
import { Overlay } from "./overlay.js";
import { PairPicture } from "./pair_picture.js";
import { Cross, PixelLine } from "./pixel.js";
import { rotationText, translationText } from "./pose.js";
import { Failed, Loading } from "./state.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {import("../store.js").Schemas["NodePair"]} NodePair */
/** @typedef {import("./node_slider.js").Shown} Shown */

/** @param {{map: string, a: number, b: number, shown: Shown}} props */
export function NodePairInspector({ map, a, b, shown }) {
  const { data, error, reload } = useFetched(
    async (signal) => {
      const node = (/** @type {number} */ id) => get("/api/maps/{map}/nodes/{node_id}", { path: { map, node_id: id }, signal });
      const pair = get("/api/maps/{map}/nodes/{node_id}/pair/{other_id}", { path: { map, node_id: a, other_id: b }, signal });
      const [first, other, common] = await Promise.all([node(a), node(b), pair]);
      return { first, other, common };
    },
    [map, a, b],
  );
  useChanged(graphRevision, reload);
  const step = async (/** @type {"a" | "b"} */ which, /** @type {number} */ by) => {
    const found = await nodeBeside(map, which === "a" ? a : b, by, shown).catch(() => null);
    if (found !== null) (which === "a" ? setFirst : setSecond)(found, { replace: true });
  };
  useKeys({ j: () => void step("a", 1), k: () => void step("a", -1), J: () => void step("b", 1), K: () => void step("b", -1), x: swap });
  return html`<section class="inspector inspector-pair" aria-label=${`Nodes ${a} and ${b}`}>
    <header class="pair-heads">
      ${h(Head, { map, which: "a", id: a, shown, onStep: (by) => void step("a", by) })} ${h(Head, { map, which: "b", id: b, shown, onStep: (by) => void step("b", by) })}
      <div class="pair-tools">
        ${h(Button, { label: "Swap", keys: "X", hint: "Change places", onClick: swap })}
        ${h(Button, { icon: "close", hint: "Look at the first alone", kind: "bare", onClick: () => setSecond(null) })}
      </div>
    </header>
    <div class="inspector-body">${body()}</div>
  </section>`;

  function body() {
    if (error.value) return h(Failed, { error: error.value, what: "These nodes can't be shown beside each other.", onRetry: reload });
    return data.value ? h(Both, { map, ...data.value }) : h(Loading, {});
  }
}

/** @param {{map: string, which: "a" | "b", id: number, shown: Shown, onStep: (by: number) => void}} props */
function Head({ map, which, id, shown, onStep }) {
  const name = which.toUpperCase();
  const set = which === "a" ? setFirst : setSecond;
  const keys = which === "a" ? ["K", "J"] : ["⇧K", "⇧J"];
  return html`<section class="pair-head" aria-label=${`Node ${name}`}>
    <div class="pair-id">
      ${h(Chip, { label: name, on: side.value === which, hint: `Clicks in the table and in the 3D view go to node ${name}`, onChange: () => (side.value = which) })}
      <input
        class="field number"
        type="number"
        min="1"
        aria-label=${`Id of node ${name}`}
        value=${id}
        onChange=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => Number(currentTarget.value) > 0 && set(Number(currentTarget.value))}
      />
      ${h(Button, { label: "‹", hint: `Previous node (${keys[0]})`, onClick: () => onStep(-1) })}${h(Button, { label: "›", hint: `Next node (${keys[1]})`, onClick: () => onStep(1) })}
    </div>
    ${h(NodeSlider, { map, id, label: `Through the nodes, ${name}`, shown, onPick: (next) => set(next, { replace: true }) })}
  </section>`;
}

/** @param {{map: string, first: NodeDetail, other: NodeDetail, common: NodePair}} props */
function Both({ map, first, other, common }) {
  const [large, setLarge] = useState(false);
  const left = useFeatures(map, first.id, first.features > 0);
  const right = useFeatures(map, other.id, other.features > 0);
  const picture = h(PairPicture, { map, first, other, left, right, words: common.words });
  return html`<div class="pair">
    <figure class="picture">
      ${h(PairPicture.Toggles, { words: common.words })}
      <button type="button" class="picture-large" title="Larger" onClick=${() => setLarge(true)}>${picture}</button>
      <div class="pictures">
        ${[first, other].map((node) => html`<div key=${node.id} class="picture-cell">${h(SecondPicture, { map, node, onPoint: (place) => pointAt(map, node, place) })}${isAligned(node) && h(Cross, { node: node.id })}</div>`)}
      </div>
      ${[[first, left], [other, right]].map(([node, features]) => {
        const one = /** @type {NodeDetail} */ (node);
        return h(PixelLine, { key: one.id, node: one, features: /** @type {import("./pixel.js").NodeFeatures | null} */ (features), quiet: one === first ? "Point at a pixel for its depth" : "" });
      })}
      ${[first, other].some(({ has_depth, has_right }) => has_depth || has_right) && h(DepthLook, { seconds: [...new Set([...secondsOf(first), ...secondsOf(other)])] })}
      ${large && h(Lightbox, { title: `Nodes ${first.id} and ${other.id}`, close: () => setLarge(false), children: picture })}
    </figure>
    ${h(Overlay, { from: first.id, to: other.id, measured: common.links.some(({ transform }) => transform !== null), scans: [first, other].map(({ sensors }) => Boolean(sensors.scan?.points)) })}
    ${h(Differences, { common })} ${h(Between, { first, other, common })} ${h(Beside, { first, other })}
  </div>`;
}

/** @param {{common: NodePair}} props */
function Differences({ common }) {
  /** @type {[string, NodePair["map"], string][]} */
  const rows = [
    ["Map", common.map, "By the optimised poses"],
    ["Odometry", common.odometry, "By odometry alone; none between sessions"],
    ["Truth", common.truth, "By the ground truth"],
  ];
  return html`<section aria-label="Difference of the poses">
    <h3>B as seen from A</h3>
    <table class="poses apart">
      <thead>
        <tr><th scope="col"><span class="sr-only">By</span></th><th scope="col">distance</th><th scope="col">angle</th><th scope="col">x, y, z</th><th scope="col">roll, pitch, yaw</th></tr>
      </thead>
      <tbody>
        ${rows.map(
          ([name, difference, hint]) => html`<tr key=${name} title=${hint}>
            <th scope="row">${name}</th>
            <td><b>${text.length(difference?.translation_m)}</b></td>
            <td><b>${difference ? `${text.fixed(difference.rotation_deg, 1)} °` : ""}</b></td>
            <td class="small">${difference ? translationText(difference.transform).replace(" m", "") : ""}</td>
            <td class="small">${difference ? rotationText(difference.transform).replace(" °", "") : ""}</td>
          </tr>`,
        )}
      </tbody>
    </table>
  </section>`;
}

/** @param {{first: NodeDetail, other: NodeDetail, common: NodePair}} props */
function Between({ first, other, common }) {
  const tool = link({ view: "loops", query: { tab: "link", from: String(first.id), to: String(other.id) } });
  return html`<section aria-label="Links between both">
    <h3>Links between both</h3>
    <ul class="links">
      ${common.links.map(
        ({ from, to, type, translation_m, sigma_m, sigma_deg }) => html`<li key=${`${from}-${to}-${type}`}>
          ${h(LinkName, { type })} <span>${from} → ${to}</span>
          <span class="quiet grow right">${text.length(translation_m)}${sigma_m !== null && html` <span title="Largest sigma of the three axes">± ${text.length(sigma_m)}, ${text.fixed(sigma_deg, 2)} °</span>`}</span>
          <a href=${link({ view: "loops", key: `${from}-${to}` })}>evidence</a>
        </li>`,
      )}
      ${!common.links.length && html`<li><span class="quiet grow">None.</span><a href=${tool}>Link them…</a></li>`}
    </ul>
  </section>`;
}

/** Facts of both in columns; what differs is seen at once. @param {{first: NodeDetail, other: NodeDetail}} props */
function Beside({ first, other }) {
  const others = new Map(nodeFacts(other).map(([name, value]) => [name, value]));
  return html`<table class="plain beside">
    <thead>
      <tr><th scope="col"><span class="sr-only">Fact</span></th><th scope="col"><a href=${link({ view: "nodes", key: first.id })}>node ${first.id}</a></th><th scope="col"><a href=${link({ view: "nodes", key: other.id })}>node ${other.id}</a></th></tr>
    </thead>
    <tbody>
      ${nodeFacts(first).map(([name, value, hint]) => html`<tr key=${name} title=${hint}><th scope="row">${name}</th><td>${value}</td><td>${others.get(name)}</td></tr>`)}
      <tr><th scope="row">Apart</th><td colspan="2">${apart(first, other)}</td></tr>
    </tbody>
  </table>`;
}

/** @param {NodeDetail} first @param {NodeDetail} other */
function apart(first, other) {
  const seconds = other.stamp - first.stamp;
  return `${text.duration(Math.abs(seconds))}${seconds === 0 ? "" : seconds > 0 ? ", B is later" : ", B is earlier"}`;
}

