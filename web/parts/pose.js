// Poses as people read them: metres, and angles in degrees about the fixed axes.
import { html } from "../html.js";
import * as text from "../format.js";

/** @typedef {number[] | null | undefined} Pose x y z qx qy qz qw */

/** Roll, pitch, yaw in degrees. @param {number[]} pose */
export function rollPitchYaw([, , , x, y, z, w]) {
  const roll = Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
  const pitch = Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x))));
  const yaw = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  return [roll, pitch, yaw].map((angle) => (angle * 180) / Math.PI);
}

/** @param {number[]} pose */
export function translationText(pose) {
  return `${pose.slice(0, 3).map((value) => text.fixed(value, 3)).join("  ")} m`;
}

/** @param {number[]} pose */
export function rotationText(pose) {
  return `${rollPitchYaw(pose).map((value) => text.fixed(value, 1)).join("  ")} °`;
}

/** @param {{rows: [string, Pose, string?][]}} props name, pose, and a hint */
export function Poses({ rows }) {
  return html`<table class="poses">
    <thead>
      <tr><th scope="col"><span class="sr-only">Frame</span></th><th scope="col">x, y, z</th><th scope="col">roll, pitch, yaw</th></tr>
    </thead>
    <tbody>
      ${rows.map(
        ([name, pose, hint]) => html`<tr key=${name} title=${hint}>
          <th scope="row">${name}</th>
          ${pose
            ? html`<td>${translationText(pose)}</td>`
            : html`<td class="quiet">${text.NONE}</td>`}
          <td>${pose ? rotationText(pose) : ""}</td>
        </tr>`,
      )}
    </tbody>
  </table>`;
}
