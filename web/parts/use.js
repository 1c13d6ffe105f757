// Hooks that several views share.
import { useSignal, useSignalEffect } from "@preact/signals";
import { useCallback, useEffect, useRef, useState } from "preact/hooks";

/**
 * Fetch something when the dependencies change; the last answer stays while the next is on its way.
 * @template T
 * @param {(signal: AbortSignal) => Promise<T> | null} load null: nothing to fetch
 * @param {unknown[]} dependencies
 */
export function useFetched(load, dependencies) {
  const data = useSignal(/** @type {T | null} */ (null));
  const error = useSignal(/** @type {Error | null} */ (null));
  const latest = useRef(load);
  const reload = useRef(() => {});
  latest.current = load;
  useEffect(() => {
    const abort = new AbortController();
    let running = false;
    let again = false;
    // A slow answer is waited for, so that changes in quick succession can't starve it.
    const run = async () => {
      if (running) return void (again = true);
      [running, again] = [true, false];
      await settle(latest.current(abort.signal), abort.signal, data, error);
      running = false;
      if (again && !abort.signal.aborted) void run();
    };
    reload.current = () => void run();
    void run();
    return () => abort.abort();
  }, dependencies);
  return { data, error, reload: useCallback(() => reload.current(), []) };
}

/**
 * @template T
 * @param {Promise<T> | null} work
 * @param {AbortSignal} aborted
 * @param {{value: T | null}} data
 * @param {{value: Error | null}} error
 */
async function settle(work, aborted, data, error) {
  if (!work) return;
  try {
    const found = await work;
    if (!aborted.aborted) [data.value, error.value] = [found, null];
  } catch (failure) {
    if (!aborted.aborted) error.value = /** @type {Error} */ (failure);
  }
}

/**
 * Width of the place that an element fills, CSS pixels, followed; 0 until it is known.
 * @param {{current: Element | null}} element
 */
export function useWidth(element) {
  const [width, setWidth] = useState(0);
  useEffect(() => {
    const box = element.current?.parentElement;
    if (!box) return undefined;
    const observer = new ResizeObserver(() => setWidth(box.clientWidth));
    observer.observe(box);
    return () => observer.disconnect();
  }, []);
  return width;
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
