// The name that this browser writes beside decisions.
import { html } from "../html.js";
import { author } from "../actions.js";

export function Author() {
  return html`<label class="author small">
    <span class="quiet">Decided by</span>
    <input
      class="field"
      type="text"
      maxlength="80"
      autocomplete="name"
      placeholder="your name"
      title="Written into the journal beside what you decide; this browser remembers it"
      value=${author.value}
      onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => (author.value = currentTarget.value)}
    />
  </label>`;
}
