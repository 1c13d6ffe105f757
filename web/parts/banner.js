// What the whole page must know: the server is gone, the engine died, the link has expired.
import { useEffect, useState } from "preact/hooks";
import { signal } from "@preact/signals";
import { h, html } from "../html.js";
import { get } from "../api.js";
import { dismiss, toasts } from "../actions.js";
import { connect, connection, nextTry } from "../events.js";
import { link, openMapId } from "../router.js";
import { info, infoError, readFailure, session } from "../store.js";
import * as text from "../format.js";
import { Button } from "./button.js";
import { Faults } from "./faults.js";
import { Icon } from "./icons.js";

const refused = signal(false);
/** The map whose notes somebody has read and put away. */
const readNotes = signal(/** @type {string | null} */ (null));

export function Banners() {
  const lost = connection.value === "lost";
  useEffect(() => void (lost && probe()), [lost, nextTry.value]);
  const failure = session.value?.state === "failed" ? session.value.message : null;
  return html`<div class="banners" aria-live="assertive">
    ${lost && (refused.value ? h(Expired, {}) : h(ServerGone, {}))}
    ${!lost && failure !== null && failure !== readFailure.value && h(EngineDead, { reason: failure })}
    ${!lost && info.value && info.value.notes.length > 0 && readNotes.value !== info.value.id && h(MapNotes, { info: info.value })}
    ${!lost && infoError.value && h(MapFailed, { error: infoError.value })}
    ${!lost && info.value?.id === openMapId.value && h(MapDamaged, { map: info.value })}
  </div>`;
}

/** A browser doesn't say why a WebSocket was closed; the API does. */
async function probe() {
  refused.value = await get("/api/session", {}).then(
    () => false,
    (error) => error.status === 401 || error.status === 403,
  );
}

function ServerGone() {
  const [now, setNow] = useState(Date.now());
  useEffect(() => {
    const timer = setInterval(() => setNow(Date.now()), 500);
    return () => clearInterval(timer);
  }, []);
  const seconds = Math.max(0, Math.ceil((nextTry.value - now) / 1000));
  return html`<div class="banner banner-bad" role="alert" id="server-gone">
    ${h(Icon, { name: "offline" })}
    <span class="grow"
      ><b>The server is gone.</b> What you see is the last that arrived. Start it again with <code>slamdeck serve</code>; the page
      reconnects by itself${seconds > 0 ? ` (next try in ${seconds} s)` : " (trying now)"}.</span
    >
    ${h(Button, { label: "Try now", onClick: connect })}
  </div>`;
}

function Expired() {
  return html`<div class="banner banner-bad" role="alert" id="expired">
    ${h(Icon, { name: "warn" })}
    <span class="grow"
      ><b>This browser isn't let in any more.</b> The server was started anew: open the address with the token that its terminal
      printed.</span
    >
  </div>`;
}

/** @param {{reason: string}} props */
function EngineDead({ reason }) {
  return html`<div class="banner banner-bad" role="alert" id="engine-dead">
    ${h(Icon, { name: "warn" })}
    <span class="grow clip" title=${reason}
      ><b>The engine stopped:</b> ${reason.replace(/\.$/, "")}. The map is sound up to its last node; start a new run, or go on looking.</span
    >
    <a class="button button-plain" href=${link({ view: "maps" })}>Start a run</a>
    ${h(Button, { icon: "close", hint: "Hide this message", onClick: () => (readFailure.value = reason) })}
  </div>`;
}

/** @param {{info: import("../store.js").Schemas["MapInfo"]}} props */
function MapNotes({ info: { id, name, notes } }) {
  const more = notes.length > 1 ? html` <a href=${link({ view: "maps" })}>${notes.length - 1} more</a>` : "";
  return html`<div class="banner" role="status" id="map-notes">
    ${h(Icon, { name: "warn" })}
    <span class="grow"><b>${name}:</b> ${notes[0]}${more}</span>
    ${h(Button, { icon: "close", hint: "Hide this message", onClick: () => (readNotes.value = id) })}
  </div>`;
}

const hidden = signal("");

/** @param {{map: import("../store.js").Schemas["MapInfo"] | null}} props */
function MapDamaged({ map }) {
  if (!map?.fault_count || hidden.value === map.id) return null;
  const rows = text.plural(map.fault_count, "row of this file makes", "rows of this file make");
  return html`<div class="banner" role="status" id="map-damaged">
    ${h(Icon, { name: "warn" })}
    <details class="grow">
      <summary>${rows} no sense; everything else is shown.</summary>
      ${h(Faults, { faults: map.faults })}
    </details>
    ${h(Button, { icon: "close", hint: "Hide this message", onClick: () => (hidden.value = map.id) })}
  </div>`;
}

/** @param {{error: Error}} props */
function MapFailed({ error }) {
  return html`<div class="banner banner-bad" role="alert" id="map-failed">
    ${h(Icon, { name: "warn" })}
    <span class="grow"><b>${openMapId.value} can't be opened.</b> ${error.message}</span>
    <a class="button button-plain" href=${link({ map: null, view: "maps" })}>All maps</a>
  </div>`;
}

export function Toasts() {
  return html`<div class="toasts" role="status" aria-live="polite">
    ${toasts.value.map(
      ({ id, kind, text }) => html`<div key=${id} class=${`toast toast-${kind}`}>
        <span class="grow">${text}</span>${h(Button, { icon: "close", hint: "Dismiss", kind: "bare", onClick: () => dismiss(id) })}
      </div>`,
    )}
  </div>`;
}
