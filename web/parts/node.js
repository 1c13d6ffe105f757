// The inspector of one node: images, poses, links, statistics of its update.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { link } from "../router.js";
import { setFirst, setSecond } from "../pair.js";
import { graphRevision } from "../store.js";
import { Button } from "./button.js";
import { Facts } from "./facts.js";
import { Faults } from "./faults.js";
import { NodeImages } from "./node_images.js";
import { LinkName } from "./link_name.js";
import { NodeEdit } from "./node_edit.js";
import { nodeFacts } from "./node_facts.js";
import { NodePlans } from "./node_plans.js";
import { NodeScene } from "./node_scene.js";
import { NodeSlider } from "./node_slider.js";
import { Poses, rotationText, translationText } from "./pose.js";
import { Sensors } from "./sensors.js";
import { Failed, Loading } from "./state.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */

/** @param {{map: string, id: number, shown: import("./node_slider.js").Shown}} props */
export function NodeInspector({ map, id, shown }) {
  const { data, error, reload } = useFetched(
    (signal) => get("/api/maps/{map}/nodes/{node_id}", { path: { map, node_id: id }, signal }),
    [map, id],
  );
  useChanged(graphRevision, reload);
  if (error.value) return h(Failed, { error: error.value, what: `Node ${id} can't be shown.`, onRetry: reload });
  const node = data.value;
  if (!node) return h(Loading, {});
  return html`<section class="inspector" aria-label=${`Node ${node.id}`}>
    <header class="inspector-head">
      <h2>Node ${node.id}</h2>
      <span class="quiet clip">${node.label}</span>
      ${h(NodeSlider, { map, id, label: "Through the nodes", shown, onPick: (next) => setFirst(next, { replace: true }) })}
      ${h(Button, { id: "compare", label: "Compare…", hint: "A second node beside it", onClick: () => setSecond(companion(node)) })}
    </header>
    <div class="inspector-body">
      ${h(NodeImages, { map, node })} ${h(NodeScene, { node })} ${node.faults.length > 0 && h(Faults, { faults: node.faults })}
      ${h(NodeEdit, { node, onDone: reload })}
      ${h(Facts, { facts: nodeFacts(node).filter(([name]) => name !== "Label") })}
      ${h(Poses, { rows: [["Map", node.pose], ["Odometry", node.odom], ["Truth", node.truth, "Ground truth, laid over the path of the map"]] })}
      ${h(Sensors, { node })} ${h(NodePlans, { map, node })} ${h(Links, { node })} ${h(Statistics, { values: node.statistics })}
    </div>
  </section>`;
}

/** The node to begin a comparison with: one that a loop ties to this, else a neighbour. @param {NodeDetail} node */
function companion({ id, links }) {
  const others = links.filter(({ from, to, transform }) => from > 0 && to > 0 && from !== to && transform !== null);
  const chosen = others.find(({ type }) => /Closure$/.test(type)) ?? others[0];
  if (!chosen) return id;
  return chosen.from === id ? chosen.to : chosen.from;
}

/** @param {{node: NodeDetail}} props */
function Links({ node }) {
  if (!node.links.length) return html`<p class="quiet">No links: this node stands alone in the graph.</p>`;
  return html`<section>
    <h3>Links</h3>
    <ul class="links">
      ${node.links.map(({ from, to, type, translation_m, transform, sigma_m, sigma_deg }) => {
        const other = from === node.id ? to : from;
        const own = from === to || to < 0;
        const merged = !own && translation_m === null;
        return html`<li key=${`${from}-${to}-${type}`}>
          ${own
            ? html`<span>${to < 0 ? `landmark ${-to}` : "itself"}</span>`
            : html`<a href=${link({ view: "nodes", key: other })}>node ${other}</a>`}
          ${merged ? html`<span class="quiet">${from === node.id ? "merged into it" : "merged into this"}</span>` : h(LinkName, { type })}
          <span class="quiet grow right clip" title=${sigma_m === null ? undefined : `Sigma at most ${text.length(sigma_m)} and ${text.fixed(sigma_deg, 2)} °`}>${merged ? "" : measured(type, from === to, transform, translation_m)}</span>
          ${!own &&
          !merged &&
          html`<a href=${link({ view: "loops", key: `${from}-${to}` })} aria-label=${`Evidence of link ${from} to ${to}`}>evidence</a>`}
        </li>`;
      })}
    </ul>
  </section>`;
}

/**
 * Of gravity roll and pitch, of a prior the whole pose, of others their length.
 * @param {string} type
 * @param {boolean} own
 * @param {number[] | null | undefined} transform
 * @param {number | null} translation_m
 */
function measured(type, own, transform, translation_m) {
  if (!own || !transform) return text.length(translation_m);
  if (type === "Gravity") return `roll, pitch ${rotationText(transform).split("  ").slice(0, 2).join("  ")} °`;
  return `${translationText(transform)}, ${rotationText(transform)}`;
}

/** @param {{values: Record<string, number>}} props */
function Statistics({ values }) {
  const [query, setQuery] = useState("");
  const names = Object.keys(values).filter((name) => name.toLowerCase().includes(query.toLowerCase()));
  if (!Object.keys(values).length) return html`<p class="quiet">No statistics are stored with this node.</p>`;
  return html`<details class="fold">
    <summary>Statistics of its update <span class="quiet">${Object.keys(values).length}</span></summary>
    <input
      type="search"
      class="field wide"
      placeholder="Find a statistic"
      aria-label="Find a statistic"
      value=${query}
      onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => setQuery(currentTarget.value)}
    />
    <table class="plain">
      <tbody>
        ${names.map(
          (name) => html`<tr key=${name}>
            <th scope="row"><a href=${link({ view: "stats", query: { names: name } })}>${name}</a></th>
            <td class="right">${text.short(values[name])}</td>
          </tr>`,
        )}
      </tbody>
    </table>
  </details>`;
}
