// The inspector of one node: images, poses, links, statistics of its update.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { link } from "../router.js";
import { graphRevision } from "../store.js";
import { Facts } from "./facts.js";
import { Faults } from "./faults.js";
import { NodeImages } from "./node_images.js";
import { LinkName } from "./link_name.js";
import { NodeEdit } from "./node_edit.js";
import { Poses } from "./pose.js";
import { Sensors } from "./sensors.js";
import { Failed, Loading } from "./state.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */

/** @param {{map: string, id: number, key?: unknown}} props */
export function NodeInspector({ map, id }) {
  const { data, error, reload } = useFetched(
    (signal) => get("/api/maps/{map}/nodes/{node_id}", { path: { map, node_id: id }, signal }),
    [map, id],
  );
  useChanged(graphRevision, reload);
  if (error.value) return h(Failed, { error: error.value, what: `Node ${id} can't be shown.`, onRetry: reload });
  const node = data.value;
  if (!node) return h(Loading, {});
  return html`<section class="inspector" aria-label=${`Node ${id}`}>
    <header class="inspector-head">
      <h2>Node ${id}</h2>
      <span class="quiet">${node.label}</span>
    </header>
    <div class="inspector-body">
      ${h(NodeImages, { map, node })} ${node.faults.length > 0 && h(Faults, { faults: node.faults })}
      ${h(NodeEdit, { node, onDone: reload })}
      ${h(Facts, {
        facts: [
          ["Time", text.clock(node.stamp)],
          ["Session", text.whole(node.map_id)],
          ["Memory", node.tier?.toUpperCase() ?? text.NONE],
          ["Weight", weightText(node.weight)],
          ["Features", text.whole(node.features)],
          ["Words", text.whole(node.words)],
        ],
      })}
      ${h(Poses, { rows: [["Map", node.pose], ["Odometry", node.odom], ["Truth", node.truth, "Ground truth, laid over the path of the map"]] })}
      ${h(Sensors, { node })} ${h(Links, { node })} ${h(Statistics, { values: node.statistics })}
    </div>
  </section>`;
}

/** Weights that are none say what the node is. @param {number} weight */
function weightText(weight) {
  if (weight === -9) return "none: merged or dropped";
  return weight === -1 ? "none: only in the graph" : text.whole(weight);
}

/** @param {{node: NodeDetail}} props */
function Links({ node }) {
  if (!node.links.length) return html`<p class="quiet">No links: this node stands alone in the graph.</p>`;
  return html`<section>
    <h3>Links</h3>
    <ul class="links">
      ${node.links.map(({ from, to, type, translation_m }) => {
        const other = from === node.id ? to : from;
        const own = from === to || to < 0;
        const merged = !own && translation_m === null;
        return html`<li key=${`${from}-${to}-${type}`}>
          ${own
            ? html`<span>${to < 0 ? `landmark ${-to}` : "itself"}</span>`
            : html`<a href=${link({ view: "nodes", key: other })}>node ${other}</a>`}
          ${merged ? html`<span class="quiet">${from === node.id ? "merged into it" : "merged into this"}</span>` : h(LinkName, { type })}
          <span class="quiet grow right">${type === "Gravity" || merged ? "" : text.length(translation_m)}</span>
          ${!own &&
          !merged &&
          html`<a href=${link({ view: "loops", key: `${from}-${to}` })} aria-label=${`Evidence of link ${from} to ${to}`}>evidence</a>`}
        </li>`;
      })}
    </ul>
  </section>`;
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
