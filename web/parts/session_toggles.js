// Sessions that the 3D view shows.
import { h, html } from "../html.js";
import { setScene } from "../actions.js";
import * as text from "../format.js";
import { info, scene } from "../store.js";
import { Chip } from "./button.js";

export function SessionToggles() {
  const sessions = info.value?.session_list ?? [];
  if (sessions.length < 2) return null;
  const hidden = scene.value?.hidden_sessions ?? [];
  const toggle = (/** @type {number} */ id, /** @type {boolean} */ on) => void setScene({ hidden_sessions: on ? hidden.filter((one) => one !== id) : [...hidden, id] });
  return html`<section class="graph-part" aria-label="Sessions that show">
    <div class="graph-head">
      <h3 class="grow">Sessions</h3>
      ${hidden.length > 0 && html`<button type="button" class="button button-plain" onClick=${() => void setScene({ hidden_sessions: [] })}>Show all</button>`}
    </div>
    <div class="graph-chips">
      ${sessions.map(({ map_id, nodes, source }) =>
        h(Chip, { key: map_id, label: `${map_id} · ${text.plural(nodes, "node")}`, hint: source, on: !hidden.includes(map_id), disabled: !scene.value, onChange: (on) => toggle(map_id, on) }),
      )}
    </div>
  </section>`;
}
