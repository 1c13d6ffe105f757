// What the 3D view shows now, as a picture. For the frame around it: the page may not look into the view.

/** Frames to wait for one that is drawn, as a view that stands still draws none of itself. */
const MOST_FRAMES = 30;

/**
 * @param {HTMLIFrameElement} view same-origin
 * @param {string} ground colour behind what is drawn
 * @returns {Promise<Blob | null>} PNG in the pixels in which it is drawn; null where nothing was drawn
 */
export async function pictureOf({ contentDocument: inside, contentWindow: its }, ground) {
  if (!inside || !its) return null;
  for (let tried = 0; tried < MOST_FRAMES; tried += 1) {
    const shown = largest(inside);
    const picture = shown && (await drawnIn(its, shown, ground));
    if (picture) return picture.convertToBlob({ type: "image/png" });
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
 * @param {Window} its
 * @param {HTMLCanvasElement} shown
 * @param {string} ground
 * @returns {Promise<OffscreenCanvas | null>} null where nothing was drawn in this frame
 */
function drawnIn(its, shown, ground) {
  return new Promise((resolve) =>
    its.requestAnimationFrame(() => {
      const picture = new OffscreenCanvas(shown.width, shown.height);
      const ctx = /** @type {OffscreenCanvasRenderingContext2D} */ (picture.getContext("2d", { willReadFrequently: true }));
      ctx.drawImage(shown, 0, 0);
      if (isEmpty(ctx, picture)) return resolve(null);
      ctx.globalCompositeOperation = "destination-over";
      ctx.fillStyle = ground;
      ctx.fillRect(0, 0, picture.width, picture.height);
      return resolve(picture);
    }),
  );
}

/** @param {OffscreenCanvasRenderingContext2D} ctx @param {OffscreenCanvas} picture */
function isEmpty(ctx, { width, height }) {
  return !new Uint32Array(ctx.getImageData(0, 0, width, height).data.buffer).some(Boolean);
}
