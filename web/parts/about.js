// What the open map is: what its file lacks, its sessions, its landmarks.
import { h, html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { link } from "../router.js";
import { info } from "../store.js";
import { Facts } from "./facts.js";
import { useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["MapInfo"]} MapInfo */

/** @param {{map: string}} props */
export function About({ map }) {
  const found = info.value;
  if (!found || found.id !== map) return null;
  const links = Object.entries(found.links).map(([type, count]) => `${type} ${text.whole(count)}`);
  return html`<section class="about" aria-label=${`About ${found.name}`}>
    ${h(Notes, { notes: found.notes })}
    ${h(Facts, {
      facts: [
        ["Nodes", text.whole(found.nodes)],
        ["Merged, dropped", text.whole(found.dropped), "Kept in the file, but no part of the map (weight -9)"],
        ["Words", text.whole(found.words)],
        ["Features", text.whole(found.features)],
        ["Length", `${text.length(found.map_m ?? found.odometry_m)}${found.map_m === null ? " by odometry" : ""}`, `By odometry ${text.length(found.odometry_m)}; sessions added up`],
        ["Time", text.duration(found.span_s), "From the first node to the last, sessions added up"],
        ["Format", found.version],
        ["Parameters", found.parameters ? `${Object.keys(found.parameters).length} changed` : text.NONE, "Those that differ from the defaults"],
      ],
    })}
    <p class="quiet small">${links.join(" · ")}</p>
    ${h(Sessions, { sessions: found.session_list })} ${found.links.Landmark && h(Landmarks, { map })}
  </section>`;
}

/** @param {{notes: string[]}} props */
function Notes({ notes }) {
  if (!notes.length) return null;
  return html`<ul class="notes">
    ${notes.map((note) => html`<li key=${note} class="ink-warn small">${note}</li>`)}
  </ul>`;
}

/** @param {{sessions: MapInfo["session_list"]}} props */
function Sessions({ sessions }) {
  if (sessions.length < 2) return null;
  return html`<table class="plain" aria-label="Sessions">
    <tbody>
      ${sessions.map(
        ({ map_id, nodes, source, clean, joined_with }) => html`<tr key=${map_id}>
          <th scope="row">Session ${map_id}</th>
          <td>${text.plural(nodes, "node")}</td>
          <td class="quiet">${joined_with.length ? `one map with ${joined_with.join(", ")}` : "on its own"}${clean ? "" : ", not closed in order"}</td>
          <td class="quiet clip">${source}</td>
        </tr>`,
      )}
    </tbody>
  </table>`;
}

/** @param {{map: string, key?: unknown}} props */
function Landmarks({ map }) {
  const { data } = useFetched((signal) => get("/api/maps/{map}/landmarks", { path: { map }, signal }), [map]);
  if (!data.value?.landmarks.length) return null;
  return html`<table class="plain" aria-label="Landmarks">
    <tbody>
      ${data.value.landmarks.map(
        ({ id, pose, length_m, seen_from }) => html`<tr key=${id}>
          <th scope="row">Landmark ${id}</th>
          <td>${pose ? `${pose.slice(0, 3).map((value) => text.fixed(value)).join("  ")} m` : "no pose"}</td>
          <td class="quiet">${length_m ? `side ${text.length(length_m)}` : ""}</td>
          <td class="quiet">seen from ${seen_from.map((node) => html`<a key=${node} href=${link({ map, view: "nodes", key: node })}>${node}</a> `)}</td>
        </tr>`,
      )}
    </tbody>
  </table>`;
}
