// The frame of the 3D view (frame.js): it gets the page's ground colour, and Ctrl+K comes back from it. A view that
// does not come says so.
import { useEffect, useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { setScene } from "../actions.js";
import { color, theme } from "../theme.js";
import { viewer } from "../viewer.js";
import { openPalette } from "./palette.js";
import { Failed } from "./state.js";

/** @typedef {"coming" | "here" | "drawn" | "failed" | "late"} State */

/** Longest wait for the view before it is said that it does not come; it may come all the same. */
const PATIENCE_MS = 30_000;
/** And for a word of the frame, once it has loaded: another process of the browser sends it. */
const WORD_MS = 3_000;
/** @type {Partial<Record<State, string>>} */
const WHY = {
  failed: "The server answered with an error. Try again; if it stays away, look at what slamdeck serve says in its terminal.",
  late: "The server has not sent it yet. Wait, or try again.",
};

/** @param {{map: string, key?: unknown}} props */
export function SceneFrame({ map }) {
  const frame = useRef(/** @type {HTMLIFrameElement | null} */ (null));
  const source = useRef("");
  const [tried, setTried] = useState(0);
  const [state, setState] = useState(/** @type {State} */ ("coming"));
  source.current ||= `frame.html?${new URLSearchParams({ map, viewer, ground: color("canvas") })}`;
  const now = theme.value;
  const paint = () => frame.current?.contentWindow?.postMessage({ ground: color("canvas") }, location.origin);
  useEffect(() => {
    paint();
    setScene({ dark: now === "dark" });
  }, [now, map]);
  useEffect(() => {
    const listen = (/** @type {MessageEvent} */ { origin, source, data }) => {
      if (origin !== location.origin || source !== frame.current?.contentWindow) return;
      if (data === "palette") openPalette();
      if (data === "here" || data === "drawn" || data === "failed") setState(data);
    };
    addEventListener("message", listen);
    return () => removeEventListener("message", listen);
  }, []);
  useEffect(() => {
    const late = setTimeout(() => setState((now) => (now === "coming" || now === "here" ? "late" : now)), PATIENCE_MS);
    return () => clearTimeout(late);
  }, [tried]);
  const again = () => (setState("coming"), setTried(tried + 1));
  // The page may not look into the frame: one that says nothing is what the server sent instead of it.
  const arrived = () => {
    paint();
    setTimeout(() => setState((now) => (now === "coming" ? "failed" : now)), WORD_MS);
  };
  const why = WHY[state];
  return html`<iframe key=${tried} ref=${frame} class="scene-frame" title=${`3D view of ${map}`} src=${source.current} onLoad=${arrived}></iframe>
    ${why && html`<div class="scene-gone">${h(Failed, { error: new Error(why), what: "The 3D view did not come.", onRetry: again })}</div>`}`;
}
