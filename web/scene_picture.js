// What the 3D view shows now, as a picture.
import { say } from "./actions.js";
import { openMapId } from "./router.js";
import { save } from "./save.js";
import { color } from "./theme.js";

/** Frames to wait for one that is drawn, as a view that stands still draws none of itself. */
const MOST_FRAMES = 30;

/** Save the 3D view as PNG, in the pixels in which it is drawn. */
export async function saveScene() {
  const frame = /** @type {HTMLIFrameElement | null} */ (document.querySelector("iframe.scene-frame"));
  const picture = frame && (await captured(frame));
  if (!picture) return say("The 3D view has drawn nothing yet; try again when it shows the map.");
  picture.toBlob((blob) => blob && save(blob, `${openMapId.value}-3d.png`), "image/png");
}

/** @param {HTMLIFrameElement} frame same-origin @returns {Promise<HTMLCanvasElement | null>} */
async function captured({ contentDocument: inside, contentWindow: view }) {
  if (!inside || !view) return null;
  for (let tried = 0; tried < MOST_FRAMES; tried += 1) {
    const shown = largest(inside);
    const picture = shown && (await drawnIn(view, shown));
    if (picture) return picture;
  }
  return null;
}

/** @param {Document} inside */
function largest(inside) {
  const all = [...inside.querySelectorAll("canvas")].filter(({ width, height }) => width * height > 0);
  return all.sort((a, b) => b.width * b.height - a.width * a.height)[0] ?? null;
}

/**
 * A copy taken in the frame in which it was drawn: afterwards WebGL has thrown its picture away.
 * @param {Window} view
 * @param {HTMLCanvasElement} shown
 * @returns {Promise<HTMLCanvasElement | null>} null where nothing was drawn in this frame
 */
function drawnIn(view, shown) {
  return new Promise((resolve) =>
    view.requestAnimationFrame(() => {
      const picture = document.createElement("canvas");
      [picture.width, picture.height] = [shown.width, shown.height];
      const ctx = /** @type {CanvasRenderingContext2D} */ (picture.getContext("2d", { willReadFrequently: true }));
      ctx.drawImage(shown, 0, 0);
      if (isEmpty(ctx, picture)) return resolve(null);
      ctx.globalCompositeOperation = "destination-over";
      ctx.fillStyle = color("canvas");
      ctx.fillRect(0, 0, picture.width, picture.height);
      return resolve(picture);
    }),
  );
}

/** @param {CanvasRenderingContext2D} ctx @param {HTMLCanvasElement} picture */
function isEmpty(ctx, { width, height }) {
  return !new Uint32Array(ctx.getImageData(0, 0, width, height).data.buffer).some(Boolean);
}
