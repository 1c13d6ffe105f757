// Numbers as people read them: units beside them, a true minus sign, a dash where there is nothing.

export const NONE = "—";

/** @typedef {number | null | undefined} Maybe */

/**
 * @param {Maybe} value
 * @param {number} [digits] after the point
 */
export function fixed(value, digits = 2) {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  return value.toFixed(digits).replace("-", "−");
}

/** At most four significant digits, without trailing zeros. @param {Maybe} value */
export function short(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  if (Number.isInteger(value)) return whole(value);
  const size = Math.abs(value);
  const text = size >= 1e5 || size < 1e-3 ? value.toExponential(2) : String(Number(value.toPrecision(4)));
  return text.replace("-", "−");
}

/** @param {Maybe} value */
export function whole(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  return Math.round(value).toLocaleString("en").replace("-", "−");
}

/** A length in the unit that suits it. @param {Maybe} metres */
export function length(metres) {
  if (metres === null || metres === undefined || !Number.isFinite(metres)) return NONE;
  const size = Math.abs(metres);
  if (size < 0.01) return `${fixed(metres * 1000, 1)} mm`;
  return size < 1 ? `${fixed(metres * 100, 1)} cm` : `${fixed(metres, 2)} m`;
}

/** A span of time. @param {number} seconds 0 or more */
export function duration(seconds) {
  if (seconds < 120) return `${fixed(seconds, 2)} s`;
  return seconds < 7200 ? `${fixed(seconds / 60, 1)} min` : `${fixed(seconds / 3600, 1)} h`;
}

/** @param {Maybe} bytes */
export function size(bytes) {
  if (bytes === null || bytes === undefined) return NONE;
  const units = ["B", "kB", "MB", "GB"];
  let value = bytes;
  let unit = 0;
  while (value >= 1000 && unit < units.length - 1) {
    value /= 1000;
    unit += 1;
  }
  return `${unit === 0 || value >= 100 ? Math.round(value) : value.toFixed(1)} ${units[unit]}`;
}

/** @param {Maybe} seconds since 1970 */
export function ago(seconds) {
  if (!seconds) return NONE;
  const past = Date.now() / 1000 - seconds;
  if (past < 90) return "just now";
  if (past < 5400) return `${Math.round(past / 60)} min ago`;
  if (past < 129600) return `${Math.round(past / 3600)} h ago`;
  return new Date(seconds * 1000).toISOString().slice(0, 10);
}

/** The last second that a date of JavaScript can be; damaged files have stamps beyond. */
const LAST_SECOND = 8.64e12;

/** @param {Maybe} seconds since 1970 */
export function clock(seconds) {
  if (seconds === null || seconds === undefined || !(Math.abs(seconds) <= LAST_SECOND)) return NONE;
  return new Date(seconds * 1000).toISOString().slice(11, 19);
}

/** Stamps before this, in seconds, count from some other beginning than 1970. */
const FIRST_SECOND = 1e8;

/** The day of a stamp. @param {Maybe} seconds since 1970 */
export function day(seconds) {
  if (seconds === null || seconds === undefined || !(seconds >= FIRST_SECOND && seconds <= LAST_SECOND)) return NONE;
  return new Date(seconds * 1000).toISOString().slice(0, 10);
}

/** @param {number} count @param {string} one @param {string} [many] */
export function plural(count, one, many = `${one}s`) {
  return `${whole(count)} ${count === 1 ? one : many}`;
}
