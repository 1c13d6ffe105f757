// The frame of the 3D view (frame.js): it gets the page's ground colour, and Ctrl+K comes back from it.
import { useEffect, useRef } from "preact/hooks";
import { html } from "../html.js";
import { setScene } from "../actions.js";
import { color, theme } from "../theme.js";
import { viewer } from "../viewer.js";
import { openPalette } from "./palette.js";

/** @param {{map: string, key?: unknown}} props */
export function SceneFrame({ map }) {
  const frame = useRef(/** @type {HTMLIFrameElement | null} */ (null));
  const source = useRef("");
  source.current ||= `frame.html?${new URLSearchParams({ map, viewer, ground: color("canvas") })}`;
  const now = theme.value;
  const paint = () => frame.current?.contentWindow?.postMessage({ ground: color("canvas") }, location.origin);
  useEffect(() => {
    paint();
    setScene({ dark: now === "dark" });
  }, [now, map]);
  useEffect(() => {
    const listen = (/** @type {MessageEvent} */ { origin, source, data }) => {
      if (origin === location.origin && source === frame.current?.contentWindow && data === "palette") openPalette();
    };
    addEventListener("message", listen);
    return () => removeEventListener("message", listen);
  }, []);
  return html`<iframe ref=${frame} class="scene-frame" title=${`3D view of ${map}`} src=${source.current} onLoad=${paint}></iframe>`;
}
