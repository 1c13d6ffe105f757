// Who looks: each window has a 3D view of its own, which a reload comes back to.
const KEY = "slamdeck.viewer";

export const viewer = remembered();

function remembered() {
  const made = crypto.getRandomValues(new Uint32Array(2)).join("-");
  try {
    const known = sessionStorage.getItem(KEY);
    if (known) return known;
    sessionStorage.setItem(KEY, made);
  } catch {
    // Storage is blocked: a reload is another viewer then.
  }
  return made;
}
