// What can be taken along: poses, the floor plan, the cloud, the 3D view as it is.
import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { h, html } from "../html.js";
import { say } from "../actions.js";
import { address, file } from "../api.js";
import { remembered } from "../prefs.js";
import { openMapId } from "../router.js";
import { save } from "../save.js";
import { saveScene } from "../scene_picture.js";
import { info } from "../store.js";
import { Button } from "./button.js";
import { NumberField, SelectField } from "./inputs.js";

/** @type {[string, string][]} */
export const FORMATS = [
  ["tum", "TUM"],
  ["tum-id", "TUM with ids"],
  ["rgbd-slam", "RGBD-SLAM"],
  ["raw", "raw matrices"],
  ["kitti", "KITTI"],
  ["toro", "TORO graph"],
  ["g2o", "g2o graph"],
  ["kml", "KML (GPS)"],
];
/** @type {[string, string][]} */
const WHICH = [["optimized", "optimised"], ["odometry", "odometry"], ["truth", "ground truth"]];

const format = remembered("export-format", "tum");
const which = remembered("export-which", "optimized");
const voxel = remembered("export-voxel", "0.02");
const range = remembered("export-range", "6");

const shown = signal(false);
/** The file that is being made. */
const making = signal(/** @type {string | null} */ (null));
/** Why the last one was not made. */
const failed = signal(/** @type {{path: string, message: string} | null} */ (null));

export function showExports() {
  [shown.value, failed.value] = [true, null];
}

/** Have the server make a file of the open map, and save it. @param {string} path @param {string} name @param {Record<string, string>} [query] */
async function fetchAndSave(path, name, query = {}) {
  const map = /** @type {string} */ (openMapId.value);
  [making.value, failed.value] = [path, null];
  try {
    save(await file(address("api", "maps", map, "export", path), query), `${map}.${name}`);
  } catch (error) {
    const { message } = /** @type {Error} */ (error);
    if (shown.value) failed.value = { path, message };
    else say(message);
  } finally {
    making.value = null;
  }
}

/** @param {string} [as] */
export function savePoses(as = format.value) {
  const ending = as === "g2o" || as === "kml" ? as : `${as}.txt`;
  const kind = which.value === "optimized" ? "" : `${which.value}.`;
  return fetchAndSave("poses", kind + ending, { format: as, which: which.value });
}

export const saveGrid = () => fetchAndSave("grid.zip", "grid.zip");
export const saveCloud = () => fetchAndSave("cloud.ply", "ply", { voxel: voxel.value, range: range.value });

export function Exports() {
  return shown.value && openMapId.value ? h(Dialog, { close: () => (shown.value = false) }) : null;
}

/** @param {{close: () => void}} props */
function Dialog({ close }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  useEffect(() => dialog.current?.showModal(), []);
  const noTruth = info.value !== null && !info.value.has_truth;
  const kinds = noTruth ? WHICH.filter(([name]) => name !== "truth") : WHICH;
  return html`<dialog
    ref=${dialog}
    class="help exports"
    aria-label="Save from this map"
    onClose=${close}
    onClick=${(/** @type {Event} */ event) => event.target === dialog.current && close()}
  >
    <header><h2 class="grow">Save from this map</h2>${h(Button, { icon: "close", hint: "Close (Esc)", kind: "bare", onClick: close })}</header>
    ${row("Poses", "The camera's path, or the graph", "poses", () => void savePoses(), [
      h(SelectField, { label: "format", value: format.value, options: FORMATS, onChange: (value) => (format.value = value) }),
      h(SelectField, { label: "of", value: noTruth && which.value === "truth" ? "optimized" : which.value, options: kinds, onChange: (value) => (which.value = value) }),
    ])}
    ${row("Floor plan", "PGM and YAML for map_server, in one ZIP", "grid.zip", () => void saveGrid())}
    ${row("Cloud", "PLY; a long map takes a while", "cloud.ply", () => void saveCloud(), [
      h(NumberField, { label: "a point each, m", value: voxel.value, step: "0.01", hint: "Side of the voxels that have one point each, metres", onChange: (value) => (voxel.value = value) }),
      h(NumberField, { label: "up to, m", value: range.value, step: "1", hint: "Depth beyond this is left out, metres; 0 for none", onChange: (value) => (range.value = value) }),
    ])}
    ${row("3D view", "PNG of what is shown now", null, () => void saveScene())}
    <p class="quiet small">Images, GPS readings, landmarks and thinned copies: <code>slamdeck export</code></p>
  </dialog>`;
}

/**
 * @param {string} title
 * @param {string} what
 * @param {string | null} path whose making is waited for
 * @param {() => void} onSave
 * @param {unknown[]} [fields]
 */
function row(title, what, path, onSave, fields = []) {
  const busy = path !== null && making.value === path;
  return html`<section class="export-row" aria-label=${title}>
    <div class="grow">
      <h3>${title}</h3>
      ${path !== null && failed.value?.path === path ? html`<p class="ink-bad small" role="alert">${failed.value.message}.</p>` : html`<p class="quiet small">${what}</p>`}
    </div>
    ${fields}
    ${h(Button, { label: busy ? "Making…" : "Save", disabled: making.value !== null, onClick: onSave })}
  </section>`;
}
