// What a node has besides images: cameras, scan, grid, GPS, sensors, what programs attached.
import { h, html } from "../html.js";
import * as text from "../format.js";
import { Facts } from "./facts.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {import("./facts.js").Fact} Fact */

/** @param {{node: NodeDetail}} props */
export function Sensors({ node }) {
  const facts = [...cameraFacts(node), ...placeFacts(node), ...sensorFacts(node), ...attachedFacts(node)];
  const { problems } = node.sensors;
  if (!facts.length && !problems.length) return null;
  return html`<section aria-label="Sensors">
    <h3>Sensors</h3>
    ${h(Facts, { facts, columns: 1 })} ${problems.map((problem) => html`<p key=${problem} class="ink-bad small">${problem}</p>`)}
  </section>`;
}

/** @param {NodeDetail} node @returns {Fact[]} */
function cameraFacts({ cameras }) {
  return cameras.map(({ width, height, fx, fy, baseline_m }, at) => [
    cameras.length > 1 ? `Camera ${at + 1}` : "Camera",
    `${width} × ${height}, f ${text.fixed(fx, 1)}, ${text.fixed(fy, 1)} px${baseline_m ? `, baseline ${text.length(baseline_m)}` : ""}`,
  ]);
}

/** @param {NodeDetail} node @returns {Fact[]} */
function placeFacts({ sensors: { scan, grid, gps } }) {
  /** @type {Fact[]} */
  const facts = [];
  if (scan) facts.push(["Scan", `${text.plural(scan.points, "point")}${scan.normals ? " with normals" : ""}, up to ${text.length(scan.range_m)}`]);
  if (grid) {
    const { ground, obstacles, empty, cell_size_m } = grid;
    facts.push(["Local grid", `${ground} ground, ${obstacles} obstacle, ${empty} empty cells of ${text.length(cell_size_m)}`]);
  }
  if (gps) {
    const where = `${text.fixed(gps.latitude, 6)}°, ${text.fixed(gps.longitude, 6)}°, ${text.fixed(gps.altitude, 1)} m`;
    facts.push(["GPS", `${where}, ± ${text.length(gps.error)}, bearing ${text.fixed(gps.bearing, 0)}°`, "Latitude, longitude, altitude"]);
  }
  return facts;
}

/** @param {NodeDetail} node @returns {Fact[]} */
function sensorFacts({ sensors: { readings, velocity } }) {
  /** @type {Fact[]} */
  const facts = readings.map(({ name, value, unit }) => [name, `${text.short(value)} ${unit}`]);
  if (velocity?.some((part) => part !== 0)) {
    facts.push(["Velocity", `${velocity.slice(0, 3).map((part) => text.fixed(part)).join("  ")} m/s`]);
  }
  return facts;
}

/** @param {NodeDetail} node @returns {Fact[]} */
function attachedFacts({ sensors: { vectors, user_data } }) {
  /** @type {Fact[]} */
  const facts = vectors.map(({ type, size }) => ["Global descriptor", `${text.whole(size)} numbers, type ${type}`]);
  if (user_data) {
    const { rows, columns, type, text: words } = user_data;
    facts.push(["User data", words ?? `${rows} × ${columns} ${type}`]);
  }
  return facts;
}
