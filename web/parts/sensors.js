// What a node has besides images: cameras, scan, grid, GPS, sensors, what programs attached.
import { h, html } from "../html.js";
import * as text from "../format.js";
import { Facts } from "./facts.js";
import { rotationText, translationText } from "./pose.js";

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
  return cameras.map(({ width, height, fx, fy, cx, cy, baseline_m, mount }, at) => [
    cameras.length > 1 ? `Camera ${at + 1}` : "Camera",
    html`${width} × ${height}, f ${text.fixed(fx, 1)}, ${text.fixed(fy, 1)}, c ${text.fixed(cx, 1)}, ${text.fixed(cy, 1)} px${baseline_m ? `, baseline ${text.length(baseline_m)}` : ""}`,
    mount ? `In the base frame: ${translationText(mount)}, ${rotationText(mount)}` : undefined,
  ]);
}

/** @param {NodeDetail} node @returns {Fact[]} */
function placeFacts({ sensors: { scan, grid, gps } }) {
  /** @type {Fact[]} */
  const facts = [];
  if (scan) facts.push(["Scan", scanText(scan), scanHint(scan)]);
  if (grid) {
    const { ground, obstacles, empty, cell_size_m, reach_m } = grid;
    const side = text.length(2 * reach_m);
    facts.push(["Local grid", `${ground} ground, ${obstacles} obstacle, ${empty} empty cells of ${text.length(cell_size_m)}`, `${side} × ${side} around the base`]);
  }
  if (gps) {
    const where = `${text.fixed(gps.latitude, 6)}°, ${text.fixed(gps.longitude, 6)}°, ${text.fixed(gps.altitude, 1)} m`;
    const hint = `Latitude, longitude, altitude; within ${text.length(gps.error)}, bearing ${text.fixed(gps.bearing, 0)}° from north`;
    facts.push(["GPS", where, hint]);
  }
  return facts;
}

/** @typedef {NonNullable<NodeDetail["sensors"]["scan"]>} Scan */

/** @param {Scan} scan */
function scanText({ points, most, format, range_m }) {
  return `${text.whole(points)}${most > points ? ` of ${text.whole(most)}` : ""} points of ${format}, up to ${text.length(range_m)}`;
}

/** What the file says of the scanner. @param {Scan} scan */
function scanHint({ scanner_range_m: range, angles_deg: angles, mount }) {
  return [
    range && `measures ${text.length(range[0])} to ${text.length(range[1])}`,
    angles && `${text.fixed(angles[0], 1)}° to ${text.fixed(angles[1], 1)}° in steps of ${text.fixed(angles[2], 2)}°`,
    mount && `in the base frame: ${translationText(mount)}, ${rotationText(mount)}`,
  ]
    .filter(Boolean)
    .join("; ");
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
    const { rows, columns, type, bytes, text: words } = user_data;
    facts.push(["User data", words ?? `${rows} × ${columns} ${type}, ${text.size(bytes)}`]);
  }
  return facts;
}
