// What a place shows when it has nothing else: nothing yet, nothing at all, or what went wrong. Each says what to do.
import { html, h } from "../html.js";
import { Icon } from "./icons.js";

/** @param {{icon: import("./icons.js").IconName, title: string, children?: import("../html.js").Children}} props */
export function Empty({ icon, title, children }) {
  return html`<div class="empty">
    ${h(Icon, { name: icon })}
    <strong>${title}</strong>
    <div class="quiet">${children}</div>
  </div>`;
}

/** @param {{error: Error, what: string, onRetry?: () => void}} props */
export function Failed({ error, what, onRetry }) {
  return html`<div class="empty failed" role="alert">
    ${h(Icon, { name: "warn" })}
    <strong>${what}</strong>
    <div class="quiet">${error.message}</div>
    ${onRetry && html`<button type="button" class="button button-plain" onClick=${onRetry}>Try again</button>`}
  </div>`;
}

export function Loading() {
  return html`<div class="loading" role="status"><span class="sr-only">Loading</span></div>`;
}
