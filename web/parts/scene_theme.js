// Gives the 3D view the page's ground colour; it is same-origin, but has its own theme.

/** @param {HTMLIFrameElement} frame @param {boolean} dark */
export function dress(frame, dark) {
  const root = frame.contentDocument?.documentElement;
  if (!root) return;
  root.dataset.theme = dark ? "dark" : "light";
}
