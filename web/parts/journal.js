// Every decision of a person on this map, newest first.
import { h, html } from "../html.js";
import { get } from "../api.js";
import { lastDecision } from "../actions.js";
import * as text from "../format.js";
import { link } from "../router.js";
import { effectParts, PAST } from "./decision_bar.js";
import { Empty, Failed, Loading } from "./state.js";
import { useChanged, useFetched } from "./use.js";

/** @param {{map: string}} props */
export function Journal({ map }) {
  const { data, error, reload } = useFetched((signal) => get("/api/maps/{map}/decisions", { path: { map }, signal }), [map]);
  useChanged(lastDecision, reload, 50);
  if (error.value) return h(Failed, { error: error.value, what: "The journal didn't arrive.", onRetry: reload });
  if (!data.value) return h(Loading, {});
  const entries = data.value.entries.toReversed();
  if (!entries.length) {
    return h(Empty, { icon: "loops", title: "Nobody has decided anything on this map", children: "Approve (A) or reject (R) a loop of the queue; each decision is kept here and can be undone (U)." });
  }
  return html`<ol class="journal">
    ${entries.map(
      (entry) => html`<li key=${entry.id} class=${entry.undone_by ? "undone" : ""}>
        <div>
          <b>${PAST[entry.action] ?? entry.action}</b>
          ${entry.from_id
            ? html`<a href=${link({ view: "loops", key: `${entry.from_id}-${entry.to_id}`, query: { tab: "journal" } })}>${entry.from_id} → ${entry.to_id}</a>`
            : null}
          <span class="quiet grow right small">${entry.author} · ${text.ago(entry.time)}${entry.undone_by ? " · undone" : ""}</span>
        </div>
        <div class="small">${effectParts(entry.effect)}</div>
      </li>`,
    )}
  </ol>`;
}
