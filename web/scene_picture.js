// Saving what the 3D view shows now: its frame makes the picture (frame_picture.js).
import { say } from "./actions.js";
import { openMapId } from "./router.js";
import { save } from "./save.js";
import { color } from "./theme.js";

/** A frame that has not even loaded does not answer. */
const LONGEST_MS = 20_000;

/** Save the 3D view as PNG, in the pixels in which it is drawn. */
export async function saveScene() {
  const frame = /** @type {HTMLIFrameElement | null} */ (document.querySelector("iframe.scene-frame"));
  const picture = frame?.contentWindow && (await answerOf(frame.contentWindow));
  if (!picture) return say("The 3D view has drawn nothing yet; try again when it shows the map.");
  save(picture, `${openMapId.value}-3d.png`);
}

/** @param {Window} frame @returns {Promise<Blob | null>} */
function answerOf(frame) {
  return new Promise((resolve) => {
    const told = (/** @type {Blob | null} */ picture) => {
      removeEventListener("message", listen);
      clearTimeout(limit);
      resolve(picture);
    };
    const listen = (/** @type {MessageEvent} */ { origin, source, data }) => {
      if (origin === location.origin && source === frame && data && "picture" in data) told(data.picture);
    };
    const limit = setTimeout(() => told(null), LONGEST_MS);
    addEventListener("message", listen);
    frame.postMessage({ picture: color("canvas") }, location.origin);
  });
}
