// Copies the libraries the page loads, with their licences, out of node_modules. Run: npm ci && npm run vendor
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const modules = join(here, "..", "node_modules");

/** @type {Record<string, Record<string, string>>} package -> file inside it -> file here */
const wanted = {
  preact: { "dist/preact.mjs": "preact.js", "hooks/dist/hooks.mjs": "hooks.js", LICENSE: "LICENSE" },
  htm: { "dist/htm.mjs": "htm.js", LICENSE: "LICENSE" },
  "@preact/signals-core": { "dist/signals-core.mjs": "signals-core.js", LICENSE: "LICENSE" },
  "@preact/signals": { "dist/signals.mjs": "signals.js", LICENSE: "LICENSE" },
  uplot: { "dist/uPlot.esm.js": "uplot.js", "dist/uPlot.min.css": "uplot.css", LICENSE: "LICENSE" },
};

const lines = ["Vendored by update.mjs from these packages, unchanged but for the reference to source maps.", ""];
for (const [name, files] of Object.entries(wanted)) {
  const { version, license } = JSON.parse(readFileSync(join(modules, name, "package.json"), "utf8"));
  const folder = join(here, name.replace(/^@/, "").replace("/", "-"));
  mkdirSync(folder, { recursive: true });
  for (const [from, to] of Object.entries(files)) copyWithoutMap(join(modules, name, from), join(folder, to));
  lines.push(`${name} ${version} (${license})`);
}
writeFileSync(join(here, "VERSIONS"), `${lines.join("\n")}\n`);

/** @param {string} from @param {string} to */
function copyWithoutMap(from, to) {
  if (!/\.(js|css)$/.test(to)) return copyFileSync(from, to);
  const text = readFileSync(from, "utf8").replace(/\n?\/\/# sourceMappingURL=.*\s*$/, "\n");
  writeFileSync(to, text);
}
