// The iframe that holds viser: the page's ground colour, none of viser's own panels, Ctrl+K for the page.
import { useEffect, useRef } from "preact/hooks";
import { html } from "../html.js";
import { address } from "../api.js";
import { color, theme } from "../theme.js";
import { setScene } from "../actions.js";
import { viewer } from "../viewer.js";
import { openPalette } from "./palette.js";

/** viser draws on a transparent canvas; its panels repeat what the page has, and its notices cover the layers. */
const style = (/** @type {string} */ ground) => `
  html, body, body div:has(canvas) { background: ${ground} !important; }
  [data-floating-window], .mantine-Notification-root, .mantine-Paper-root:not(:has(canvas)) { display: none !important; }
`;

/** @param {{map: string, key?: unknown}} props */
export function SceneFrame({ map }) {
  const frame = useRef(/** @type {HTMLIFrameElement | null} */ (null));
  const now = theme.value;
  useEffect(() => {
    if (frame.current) paint(frame.current);
    setScene({ dark: now === "dark" });
  }, [now, map]);
  return html`<iframe
    ref=${frame}
    class="scene-frame"
    title=${`3D view of ${map}`}
    src=${`${address("viser", map, `@${viewer}`)}/?hideViserLogo`}
    onLoad=${(/** @type {{currentTarget: HTMLIFrameElement}} */ { currentTarget }) => {
      paint(currentTarget);
      listen(currentTarget);
    }}
  ></iframe>`;
}

/** @param {HTMLIFrameElement} frame same-origin, as it comes through the server's proxy */
function paint({ contentDocument: inside, contentWindow }) {
  const Sheet = /** @type {any} */ (contentWindow)?.CSSStyleSheet;
  if (!inside || !Sheet) return;
  const sheet = new Sheet();
  sheet.replaceSync(style(color("canvas")));
  inside.adoptedStyleSheets = [sheet];
}

/** viser has a palette of its own on the same keys. @param {HTMLIFrameElement} frame */
function listen({ contentWindow }) {
  contentWindow?.addEventListener(
    "keydown",
    (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "k") return;
      event.preventDefault();
      event.stopImmediatePropagation();
      openPalette();
    },
    { capture: true },
  );
}
