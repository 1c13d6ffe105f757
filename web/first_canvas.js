// The page's first canvas, made before the 3D view: the browser keeps the page waiting for its graphics process then,
// which answers at once as long as it has nothing to draw, and only after the picture of all points where there is no GPU.

/** Draw nothing, on a canvas that nobody sees. */
export function makeFirstCanvas() {
  document.createElement("canvas").getContext("2d")?.clearRect(0, 0, 1, 1);
}
