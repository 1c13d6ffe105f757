// Work that follows something that changes fast.

/**
 * One call at a time; of those that come meanwhile only the last is made.
 * @template T
 * @param {(value: T) => Promise<unknown>} work must not fail
 * @returns {(value: T) => Promise<void>}
 */
export function latest(work) {
  /** @type {{value: T} | null} */
  let next = null;
  let running = false;
  return async (value) => {
    next = { value };
    if (running) return;
    running = true;
    while (next) {
      const { value: chosen } = next;
      next = null;
      await work(chosen);
    }
    running = false;
  };
}
