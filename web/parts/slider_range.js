// Which values a slider offers: linear between narrow bounds, by powers where the range is wide or open.

/** @typedef {{steps: number, toStep: (value: number) => number, fromStep: (step: number) => number}} SliderRange */

const STEPS = 200;
const WIDE = 50;

/**
 * @param {{type: string, minimum: number | null, maximum: number | null, default: unknown}} entry
 * @param {number} value the slider reaches it even where no bound says so
 * @returns {SliderRange}
 */
export function sliderRange({ type, minimum, maximum, default: usual }, value) {
  const low = minimum ?? 0;
  const high = maximum ?? niceAbove(Math.max(Number(usual) * 4, value * 1.5, low + 10));
  const whole = type === "int";
  const span = high - low;
  if (whole && span <= STEPS) return linear(low, span, 1);
  return span > WIDE && low >= 0 ? powers(low, span, whole) : linear(low, STEPS, span / STEPS);
}

/** @param {number} low @param {number} steps @param {number} unit @returns {SliderRange} */
function linear(low, steps, unit) {
  return {
    steps,
    toStep: (value) => Math.round((value - low) / unit),
    fromStep: (step) => Number((low + step * unit).toPrecision(6)),
  };
}

/** Finer at the low end, and exact at it. @param {number} low @param {number} span @param {boolean} whole @returns {SliderRange} */
function powers(low, span, whole) {
  return {
    steps: STEPS,
    toStep: (value) => Math.round(Math.sqrt(Math.max(0, value - low) / span) * STEPS),
    fromStep: (step) => {
      const value = low + span * (step / STEPS) ** 2;
      return whole || value >= 20 ? Math.round(value) : Number(value.toPrecision(2));
    },
  };
}

/** @param {number} value */
function niceAbove(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return ([1, 2, 5, 10].find((n) => n * power >= value) ?? 10) * power;
}
