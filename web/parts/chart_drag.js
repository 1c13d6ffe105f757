// A threshold line of a chart that can be dragged up and down.

/** @typedef {import("uplot")} uPlot */
/** @typedef {{dragged?: number | null, onDrag?: (value: number) => void}} DragProps */

/** Pixels beside the line that still take hold of it. */
const NEAR_PX = 7;

/** @param {uPlot} u @param {{current: DragProps}} latest */
export function listenForDrag(u, latest) {
  const near = (/** @type {MouseEvent} */ event) => {
    const { dragged } = latest.current;
    return typeof dragged === "number" && Math.abs(u.valToPos(dragged, "y") - height(u, event)) <= NEAR_PX;
  };
  let held = false;
  u.over.addEventListener("pointermove", (event) => {
    u.over.style.cursor = held || near(event) ? "ns-resize" : "";
    if (held) latest.current.onDrag?.(u.posToVal(height(u, event), "y"));
  });
  u.over.addEventListener("pointerdown", (event) => {
    held = near(event);
    if (held) u.over.setPointerCapture(event.pointerId);
  });
  for (const end of ["pointerup", "pointercancel"]) u.over.addEventListener(end, () => (held = false));
  // The chart would begin to zoom: it listens to the mouse on the same element, so it must be kept from hearing of it.
  u.root.addEventListener("mousedown", (event) => void (held && event.stopPropagation()), true);
}

/** @param {uPlot} u @param {MouseEvent} event */
function height(u, { clientY }) {
  return clientY - u.over.getBoundingClientRect().top;
}
