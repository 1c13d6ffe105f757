// The components of the graph, and why one did not join the others.
import { h, html } from "../html.js";
import { get } from "../api.js";
import * as text from "../format.js";
import { link } from "../router.js";
import { graphRevision } from "../store.js";
import { Failed } from "./state.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {import("../types/http").Schemas["Component"]} Component */

/** @param {{map: string, key?: unknown}} props */
export function Pieces({ map }) {
  const { data, error, reload } = useFetched((signal) => get("/api/maps/{map}/components", { path: { map }, signal }), [map]);
  useChanged(graphRevision, reload);
  const found = data.value;
  if (error.value && !found) return h(Failed, { error: error.value, what: "The components didn't arrive.", onRetry: reload });
  if (!found) return null;
  return html`<section class="graph-part" aria-label="Components">
    <h3>${found.count === 1 ? "One component: all nodes hang together" : `${text.whole(found.count)} components`}</h3>
    ${found.count > 1 && html`<ul class="pieces">${found.components.map((one) => html`<li key=${one.id}>${h(Piece, { piece: one })}</li>`)}</ul>`}
    ${found.count > found.components.length && html`<p class="quiet small">The largest ${found.components.length} are listed.</p>`}
  </section>`;
}

/** @param {{piece: Component}} props */
function Piece({ piece }) {
  const range = piece.id === piece.newest ? html`${nodeLink(piece.id)}` : html`${nodeLink(piece.id)} … ${nodeLink(piece.newest)}`;
  return html`<p class="piece-head"><b>${text.plural(piece.nodes, "node")}</b> <span class="quiet">${range} · ${piece.sessions.length === 1 ? "session" : "sessions"} ${piece.sessions.join(", ")}</span></p>
    ${piece.tried > 0 && html`<p class="small">${text.plural(piece.tried, "loop")} with other components refused or taken out; the best:</p>`}
    <ul class="small">
      ${piece.near_misses.map(
        ({ from, to, reason, inliers, matches, removed }) => html`<li key=${`${from}-${to}`}>
          <a href=${link({ view: "loops", key: `${from}-${to}` })}>${from} → ${to}</a> ${removed ? "was in the graph and was taken out" : (reason?.text ?? "the file does not say why")}
          ${!reason && inliers !== null && html`<span class="quiet">${inliers} of ${text.whole(matches)} matches</span>`}
        </li>`,
      )}
    </ul>
    ${piece.tried === 0 && html`<p class="small quiet">${why(piece)}</p>`}`;
}

/** Why nothing was tried. @param {Component} piece */
function why({ guess }) {
  if (!guess) return "No loop with another component was looked at, and no update took one of its nodes for another's place.";
  const said = `The strongest hypothesis between it and another component is ${text.fixed(guess.value, 3)} (${guess.node} → ${guess.place})`;
  return guess.value < guess.threshold
    ? `${said}: Rtabmap/LoopThr is ${text.short(guess.threshold)}, so it was not tried.`
    : `${said}: it reached Rtabmap/LoopThr (${text.short(guess.threshold)}), and the file does not say why it is no loop.`;
}

/** @param {number} id */
function nodeLink(id) {
  return html`<a href=${link({ view: "nodes", key: id })}>${id}</a>`;
}
