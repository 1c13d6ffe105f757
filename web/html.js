// Elements by htm templates; components by h(Component, props), so that tsc checks their props.
import htm from "htm";
import { h } from "preact";

/** @typedef {import("preact").ComponentChildren} Children */
/** @typedef {import("preact").VNode<any>} VNode */

export { h };

/** One root element for each template. */
export const html = /** @type {(strings: TemplateStringsArray, ...values: unknown[]) => VNode} */ (
  /** @type {unknown} */ (htm.bind(/** @type {any} */ (h)))
);

/**
 * Class names out of those that hold.
 * @param {...(string | false | null | undefined)} names
 */
export function cx(...names) {
  return names.filter(Boolean).join(" ");
}
