// Every decision of a person on this map, newest first; those made together are one entry.
import { useEffect } from "preact/hooks";
import { h, html } from "../html.js";
import { get } from "../api.js";
import { decide, deciding, lastDecision } from "../actions.js";
import { on } from "../events.js";
import * as text from "../format.js";
import { link } from "../router.js";
import { Author } from "./author.js";
import { Button } from "./button.js";
import { done, EffectLine, effectParts, lockReason, THINGS } from "./decision_bar.js";
import { Empty, Failed, Loading } from "./state.js";
import { useChanged, useFetched } from "./use.js";

/** @typedef {import("../store.js").Schemas["JournalEntry"]} Entry */

/** Of one batch so many loops are named; the rest is behind a fold. */
const MOST_NAMED = 4;
const VERDICTS = ["approve", "reject", "add"];
/** Their notes say what nothing else does. */
const NOTED = ["label", "prior", "covariance"];

/** @param {{map: string, quiet: boolean}} props quiet: what the last decision did is said elsewhere */
export function Journal({ map, quiet }) {
  const { data, error, reload } = useFetched((signal) => get("/api/maps/{map}/decisions", { path: { map }, signal }), [map]);
  useChanged(lastDecision, reload, 50);
  useEffect(() => on("decision", (_, of) => of === map && reload()), [map]);
  if (error.value) return h(Failed, { error: error.value, what: "The journal didn't arrive.", onRetry: reload });
  if (!data.value) return h(Loading, {});
  const batches = together(data.value.entries).toReversed();
  return html`<div class="view-part">
    <div class="view-tools">${h(Author, {})}<span class="grow"></span>${answer("undo", "U")}${answer("redo", "⇧U")}</div>
    ${!quiet && h(EffectLine, {})}
    ${batches.length
      ? html`<ol class="journal">${batches.map((batch) => h(Batch, { key: batch[0].id, batch, loops: batch.every((entry) => isVerdict(entry, data.value?.entries ?? [])) }))}</ol>`
      : h(Empty, { icon: "loops", title: "Nobody has decided anything on this map", children: "Approve (A) or reject (R) a loop of the queue; each decision is kept here and can be undone (U)." })}
  </div>`;
}

/** @param {"undo" | "redo"} action @param {string} keys */
function answer(action, keys) {
  const locked = lockReason();
  const [label, hint] = action === "undo" ? ["Undo", "Take the last decision back"] : ["Redo", "Make the decision again that was undone last"];
  return h(Button, { id: `journal-${action}`, label, keys, hint: locked ?? hint, disabled: deciding.value || locked !== null, onClick: () => void decide({ action }) });
}

/** Whether an entry is about a loop being true, or takes such a one back. @param {Entry} entry @param {Entry[]} all @returns {boolean} */
function isVerdict(entry, all) {
  if (VERDICTS.includes(entry.action)) return true;
  const back = all.find(({ undone_by: by }) => by === entry.id);
  return back !== undefined && isVerdict(back, all);
}

/** @param {{batch: Entry[], loops: boolean, key?: unknown}} props */
function Batch({ batch, loops }) {
  const [first] = batch;
  const undone = batch.every((entry) => entry.undone_by);
  const [named, rest] = batch.length > MOST_NAMED + 1 ? [batch.slice(0, MOST_NAMED), batch.slice(MOST_NAMED)] : [batch, []];
  const actions = [...new Set(batch.map(done))].join(", ");
  return html`<li class=${undone ? "undone" : ""}>
    <div>
      <b>${actions}${batch.length > 1 ? ` ${text.whole(batch.length)} ${loops ? "loops" : things(batch)}` : ""}</b>
      ${batch.length === 1 && name(first)} ${NOTED.includes(first.action) && html`<span class="quiet small clip">${first.note}</span>`}
      <span class="quiet grow right small" title=${new Date(first.time * 1000).toLocaleString()}>${first.author} · ${text.ago(first.time)}${undone ? " · undone" : ""}</span>
    </div>
    ${batch.length > 1 &&
    html`<div class="small journal-names">
      ${named.map(name)}${rest.length > 0 && html`<details><summary>${text.whole(rest.length)} more</summary>${rest.map(name)}</details>`}
    </div>`}
    ${first.of_map && html`<div class="small quiet">${first.note}</div>`}
    <div class="small journal-effect">${effectParts(first.effect)}</div>
  </li>`;
}

/** What all entries of a batch are about; a removal cuts links as well. @param {Entry[]} batch */
function things(batch) {
  const all = new Set(batch.map(({ action }) => THINGS[action]));
  return (all.size === 1 && [...all][0]) || "entries";
}

/** @param {Entry} entry */
function name({ id, from_id: from, to_id: to, of_map: ofMap }) {
  if (ofMap) return null;
  if (from === to) return html`<a key=${id} href=${link({ view: "nodes", key: from })}>node ${from}</a>`;
  return html`<a key=${id} href=${link({ view: "loops", key: `${from}-${to}`, query: { tab: "journal" } })}>${from} → ${to}</a>`;
}

/** Entries of one batch follow each other. @param {Entry[]} entries */
function together(entries) {
  /** @type {Entry[][]} */
  const batches = [];
  for (const entry of entries) {
    const last = batches.at(-1);
    if (last && entry.batch !== null && last[0].batch === entry.batch) last.push(entry);
    else batches.push([entry]);
  }
  return batches;
}
