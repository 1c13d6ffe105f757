// Local grids made anew: of which nodes, with which parameters, and what that would be for the first of them.
import { h, html } from "../html.js";
import { get } from "../api.js";
import { graphRevision, parameters } from "../store.js";
import { NumberField, SelectField } from "./inputs.js";
import { gridCaption, gridState, Plan } from "./node_plans.js";
import { useFetched } from "./use.js";

/** @typedef {{first: string, last: string, session: string, changes: Record<string, string>}} Wanted */
/** @typedef {import("../store.js").Schemas["Parameter"]} ParameterEntry */

/** @type {Wanted} */
export const REGRID = { first: "0", last: "0", session: "", changes: {} };

/** The parameters that were given, as the server takes them. @param {Wanted} wanted */
export function changesOf({ changes }) {
  const worth = (/** @type {string} */ text) => (text === "true" || text === "false" ? text === "true" : Number(text));
  return Object.fromEntries(Object.entries(changes).filter(([, text]) => text !== "").map(([name, text]) => [name, worth(text)]));
}

/** @param {{map: string, wanted: Wanted, onChange: (wanted: Wanted) => void}} props */
export function RegridForm({ map, wanted, onChange }) {
  const set = (/** @type {Partial<Wanted>} */ change) => onChange({ ...wanted, ...change });
  const entries = (parameters.value?.parameters ?? []).filter(({ name }) => name.startsWith("Grid/"));
  return html`<div class="form-row">
      ${h(NumberField, { label: "from node", value: wanted.first, step: "1", hint: "0: from the first", onChange: (first) => set({ first }) })}
      ${h(NumberField, { label: "to node", value: wanted.last, step: "1", hint: "0: to the last", onChange: (last) => set({ last }) })}
      ${h(NumberField, { label: "only session", value: wanted.session, step: "1", hint: "Only nodes of this session; empty for all", onChange: (session) => set({ session }) })}
    </div>
    <div class="form-row" role="group" aria-label="Parameters of local grids">
      ${entries.map((entry) => h(Field, { key: entry.name, entry, value: wanted.changes[entry.name] ?? "", onChange: (value) => set({ changes: { ...wanted.changes, [entry.name]: value } }) }))}
    </div>
    ${h(Preview, { map, wanted })}`;
}

/** Empty: as the map has it. @param {{entry: ParameterEntry, value: string, onChange: (value: string) => void, key?: unknown}} props */
function Field({ entry: { name, type, value: now, unit, meaning }, value, onChange }) {
  const label = name.replace("Grid/", "") + (unit ? ` (${unit})` : "");
  const hint = `${name}: ${meaning}`;
  if (type !== "bool") return h(NumberField, { label, value, hint, placeholder: String(now), onChange });
  return h(SelectField, { label, value, hint, options: [["", now ? "on, as now" : "off, as now"], ["true", "on"], ["false", "off"]], onChange });
}

/** @param {{map: string, wanted: Wanted}} props */
function Preview({ map, wanted }) {
  const changes = JSON.stringify(changesOf(wanted));
  const asked = Number(wanted.first) || 0;
  const first = useFetched((signal) => get("/api/maps/{map}/nodes", { path: { map }, query: { limit: 1 }, signal }), [map]);
  const id = asked || first.data.value?.nodes[0]?.id || 0;
  const path = { map, node_id: id };
  const stored = useFetched((signal) => (id ? get("/api/maps/{map}/nodes/{node_id}", { path, signal }) : null), [map, id, graphRevision.value]);
  const tried = useFetched((signal) => (id ? get("/api/maps/{map}/nodes/{node_id}/grid", { path, query: { changes }, signal }) : null), [map, id, changes]);
  if (!id) return null;
  const error = stored.error.value ?? tried.error.value;
  if (error) return html`<p class="note" id="regrid-preview">${error.message}</p>`;
  const [now, then] = [stored.data.value?.sensors.grid, tried.data.value];
  return html`<div class="pictures plans" id="regrid-preview">
    ${now ? h(Plan, { map, node: id, what: "grid", reach: now.reach_m, caption: html`<b>node ${id} as it is</b> ${gridCaption(now)}`, query: gridState(now) }) : html`<div class="picture-none quiet">Node ${id} has no local grid.</div>`}
    ${then && h(Plan, { map, node: id, what: "grid", reach: then.reach_m, caption: html`<b>made anew</b> ${gridCaption(then)}`, query: new URLSearchParams({ changes }).toString() })}
  </div>`;
}
