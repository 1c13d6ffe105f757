// Rows of the file that make no sense: what they are, while everything else is shown.
import { html } from "../html.js";

/** @typedef {import("../store.js").Schemas["RowFault"]} RowFault */

/** @param {{faults: RowFault[]}} props */
export function Faults({ faults }) {
  return html`<ul class="faults quiet small" aria-label="What the file has wrong">
    ${faults.map(({ table, row, reason }) => html`<li key=${`${table} ${row} ${reason}`}><b>${table} ${row}:</b> ${reason}</li>`)}
  </ul>`;
}
