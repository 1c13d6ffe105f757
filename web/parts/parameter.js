// One parameter: slider and field, unit, bounds, default, meaning, and the value in force.
import { useEffect, useRef, useState } from "preact/hooks";
import { cx, h, html } from "../html.js";
import { setParameters } from "../actions.js";
import { link } from "../router.js";
import { drafted, draftValue } from "../trials.js";
import { Button } from "./button.js";
import { Badge } from "./facts.js";
import { Foresight } from "./foresight.js";
import { sliderRange } from "./slider_range.js";

/** @typedef {import("../store.js").Schemas["Parameter"]} ParameterEntry */
/** @typedef {ParameterEntry["value"]} Value */

const EFFECT_WORDS = { live: "takes effect at once", "next session": "takes effect with the next session", reprocess: "needs the map to be made anew" };
/** While a slider moves, the engine hears of it this often at most. */
const SEND_EVERY_MS = 150;

/** @param {{entry: ParameterEntry, live: boolean, gathered: boolean, key?: unknown}} props gathered: changes go into the draft */
export function Parameter({ entry, live, gathered }) {
  const { name, value, unit, meaning, effect } = entry;
  const [sent, setSent] = useState(/** @type {Value | null} */ (null));
  const send = useSender(name, () => setSent(null));
  const change = (/** @type {Value} */ next) => (gathered ? draftValue(name, next, value) : (setSent(next), send(next)));
  const draft = gathered ? (drafted.value[name] ?? null) : sent;
  const shown = draft ?? value;
  const locked = !gathered && effect !== "live";
  const differs = value !== entry.default;
  return html`<div class=${cx("param", gathered && draft !== null && "param-drafted")} data-name=${name}>
    <div class="param-head">
      <label for=${name} class="param-name clip">${name}</label>
      ${effect !== "live" && h(Badge, { tone: "quiet", hint: EFFECT_WORDS[effect], children: effect })}
      <span class="grow"></span>
      ${(gathered ? shown !== entry.default : differs) &&
      h(Button, {
        icon: "reset",
        kind: "bare",
        hint: `Back to the default, ${entry.default}`,
        disabled: locked,
        onClick: () => change(entry.default),
      })}
      <output class=${cx("param-force small", differs && "ink-accent")} title="The value in force, as the engine says">
        ${live ? "in force " : ""}<b>${valueText(value)}</b>${unit && value !== true && value !== false ? ` ${unit}` : ""}
      </output>
    </div>
    ${h(Control, { entry, value: shown, disabled: locked, onChange: change })}
    ${(live || draft !== null) && h(Foresight, { parameter: name, draft: Number(shown), inForce: Number(value) })}
    ${name === "Rtabmap/LoopThr" && html`<p class="small"><a href=${link({ view: "loops", query: { tab: "what-if" } })}>What if it were another? Loops that would come and go</a></p>`}
    <p class="quiet small">${meaning} <span class="param-limits">${limits(entry)}</span></p>
  </div>`;
}

/** @param {Value} value */
export function valueText(value) {
  if (typeof value === "boolean") return value ? "on" : "off";
  return typeof value === "number" ? String(value) : value.length > 24 ? `${value.slice(0, 24)}…` : value;
}

/** @param {ParameterEntry} entry */
function limits({ minimum, maximum, default: usual }) {
  const bounds =
    minimum !== null && maximum !== null ? `${minimum} to ${maximum}, ` : minimum !== null ? `${minimum} and up, ` : maximum !== null ? `up to ${maximum}, ` : "";
  return `${bounds}default ${valueText(usual)}`;
}

/** @param {{entry: ParameterEntry, value: Value, disabled: boolean, onChange: (value: Value) => void}} props */
function Control({ entry, value, disabled, onChange }) {
  const { name, type } = entry;
  if (type === "bool") {
    return html`<button
      id=${name}
      type="button"
      role="switch"
      class="switch"
      aria-checked=${value === true}
      disabled=${disabled}
      onClick=${() => onChange(!value)}
    >
      <i></i>
    </button>`;
  }
  if (entry.choices.length) return h(Choices, { entry, value, disabled, onChange });
  const field = h(Field, { entry, value, disabled, onChange });
  if (type === "text") return field;
  const range = sliderRange(entry, Number(value));
  return html`<div class="param-control">
    <input
      type="range"
      aria-label=${`${name}, slider`}
      min="0"
      max=${range.steps}
      step="1"
      value=${range.toStep(Number(value))}
      style=${{ "--filled": `${(100 * range.toStep(Number(value))) / range.steps}%` }}
      disabled=${disabled}
      onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => onChange(range.fromStep(Number(currentTarget.value)))}
    />
    ${field}
  </div>`;
}

/** @param {{entry: ParameterEntry, value: Value, disabled: boolean, onChange: (value: Value) => void}} props */
function Choices({ entry: { name, choices }, value, disabled, onChange }) {
  return html`<select
    id=${name}
    class="field wide"
    value=${String(value)}
    disabled=${disabled}
    onChange=${(/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget }) => onChange(choices[currentTarget.selectedIndex].value)}
  >
    ${choices.map((choice) => html`<option key=${choice.value} value=${String(choice.value)}>${choice.label}</option>`)}
  </select>`;
}

/** @param {{entry: ParameterEntry, value: Value, disabled: boolean, onChange: (value: Value) => void}} props */
function Field({ entry, value, disabled, onChange }) {
  const { name, type, minimum, maximum } = entry;
  // What is being typed belongs to the person until it is entered: an echo of the engine must not overwrite it.
  const [typed, setTyped] = useState(/** @type {string | null} */ (null));
  const isText = type === "text";
  return html`<input
    id=${name}
    class=${cx("field", isText ? "wide" : "number")}
    type=${isText ? "text" : "number"}
    step=${type === "int" ? 1 : "any"}
    min=${minimum}
    max=${maximum}
    value=${typed ?? String(value)}
    disabled=${disabled}
    onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => setTyped(currentTarget.value)}
    onChange=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => {
      setTyped(null);
      if (currentTarget.value !== "") onChange(isText ? currentTarget.value : Number(currentTarget.value));
    }}
  />`;
}

/**
 * Sends the newest value, not every one a slider passes.
 * @param {string} name
 * @param {() => void} onAnswer the echo is in, or the value was refused
 */
function useSender(name, onAnswer) {
  const waiting = useRef(/** @type {Value | null} */ (null));
  const timer = useRef(/** @type {ReturnType<typeof setTimeout> | null} */ (null));
  const flush = async () => {
    timer.current = null;
    const value = /** @type {Value} */ (waiting.current);
    waiting.current = null;
    await setParameters({ [name]: value });
    if (waiting.current === null) onAnswer();
  };
  useEffect(() => () => void (timer.current && (clearTimeout(timer.current), flush())), []);
  return (/** @type {Value} */ value) => {
    waiting.current = value;
    timer.current ??= setTimeout(() => void flush(), SEND_EVERY_MS);
  };
}

