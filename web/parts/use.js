// Hooks that several views share.
import { useSignal, useSignalEffect } from "@preact/signals";
import { useCallback, useEffect, useRef } from "preact/hooks";

/**
 * Fetch something when the dependencies change; the last answer stays while the next is on its way.
 * @template T
 * @param {(signal: AbortSignal) => Promise<T> | null} load null: nothing to fetch
 * @param {unknown[]} dependencies
 */
export function useFetched(load, dependencies) {
  const data = useSignal(/** @type {T | null} */ (null));
  const error = useSignal(/** @type {Error | null} */ (null));
  const running = useRef(/** @type {AbortController | null} */ (null));
  const reload = useCallback(() => {
    running.current?.abort();
    const abort = (running.current = new AbortController());
    void load(abort.signal)?.then(
      (found) => !abort.signal.aborted && ((error.value = null), (data.value = found)),
      (failure) => !abort.signal.aborted && (error.value = failure),
    );
  }, dependencies);
  useEffect(() => {
    reload();
    return () => running.current?.abort();
  }, [reload]);
  return { data, error, reload };
}

/**
 * Call back at most once in a while after the signal changed, and once more at the end.
 * @param {import("@preact/signals").ReadonlySignal<unknown>} watched
 * @param {() => void} callback
 * @param {number} [everyMs]
 */
export function useChanged(watched, callback, everyMs = 800) {
  const latest = useRef(callback);
  latest.current = callback;
  const seen = useRef(watched.peek());
  const timer = useRef(/** @type {ReturnType<typeof setTimeout> | null} */ (null));
  useSignalEffect(() => {
    if (watched.value === seen.current || timer.current) return;
    timer.current = setTimeout(() => {
      timer.current = null;
      seen.current = watched.peek();
      latest.current();
    }, everyMs);
  });
  useEffect(() => () => clearTimeout(timer.current ?? undefined), []);
}
