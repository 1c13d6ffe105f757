// The document around viser. Both may be in another process than the page (Document-Isolation-Policy), so that the page
// answers while a view draws: only messages go between them and the page.
import { address } from "./api.js";
import { pictureOf } from "./frame_picture.js";


/** viser draws on a transparent canvas; its panels repeat what the page has, and its notices cover the layers. */
const style = (/** @type {string} */ ground) => `
  html, body, body div:has(canvas) { background: ${ground} !important; }
  [data-floating-window], .mantine-Notification-root, .mantine-Paper-root:not(:has(canvas)) { display: none !important; }
`;
const OWN = `
  html, body { height: 100%; margin: 0; overflow: hidden; }
  iframe { display: block; width: 100%; height: 100%; border: 0; }
`;

const asked = new URLSearchParams(location.search);
let ground = asked.get("ground") ?? "";
const view = document.createElement("iframe");
view.title = document.title;
view.src = `${address("viser", asked.get("map") ?? "", `@${asked.get("viewer") ?? ""}`)}/?hideViserLogo`;
view.addEventListener("load", () => {
  paint();
  // What the server says instead of viser, or the browser instead of the server, has no place for a view.
  parent.postMessage(view.contentDocument?.getElementById("root") ? "drawn" : "failed", location.origin);
  // Without a view there is what the browser says about that, which nobody may look into.
  if (view.contentDocument) view.contentWindow?.addEventListener("keydown", tell, { capture: true });
});
paint();
document.body.append(view);
parent.postMessage("here", location.origin);

addEventListener("message", ({ origin, source, data }) => {
  if (origin !== location.origin || source !== parent) return;
  if (typeof data?.picture === "string") void pictureOf(view, data.picture).then((picture) => parent.postMessage({ picture }, location.origin));
  if (typeof data?.ground !== "string") return;
  ground = data.ground;
  paint();
});

function paint() {
  lay(document, window, OWN + style(ground));
  lay(view.contentDocument, view.contentWindow, style(ground));
}

/** @param {Document | null} inside @param {Window | null} its @param {string} text */
function lay(inside, its, text) {
  if (!inside || !its) return;
  const sheet = new /** @type {any} */ (its).CSSStyleSheet();
  sheet.replaceSync(text);
  inside.adoptedStyleSheets = [sheet];
}

/** viser has a palette of its own on the page's keys. @param {KeyboardEvent} event */
function tell(event) {
  if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "k") return;
  event.preventDefault();
  event.stopImmediatePropagation();
  parent.postMessage("palette", location.origin);
}
