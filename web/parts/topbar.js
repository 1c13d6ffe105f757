// The top bar: which map, what the engine does, and the commands that go with it.
import { cx, h, html } from "../html.js";
import { command } from "../actions.js";
import * as text from "../format.js";
import { link, openMapId } from "../router.js";
import { info, session } from "../store.js";
import { theme, toggleTheme } from "../theme.js";
import { Button } from "./button.js";
import { showExports } from "./exports.js";
import { Icon } from "./icons.js";
import { openPalette } from "./palette.js";

const STATE_WORDS = {
  idle: "no run",
  starting: "starting",
  running: "mapping",
  paused: "paused",
  finished: "finished",
  stopped: "stopped",
  failed: "failed",
};

export function TopBar() {
  return html`<header class="topbar">
    <h1 class="brand"><a href=${link({ map: null, view: "maps" })} title="All maps">slam<b>deck</b></a></h1>
    <button
      type="button"
      class="button button-plain switcher"
      title="Switch to another map"
      aria-haspopup="dialog"
      onClick=${() => openPalette("map: ")}
    >
      <span class="clip">${openMapId.value ?? "No map open"}</span>${h(Icon, { name: "down" })}
    </button>
    ${h(SessionState, {})}
    <span class="grow"></span>
    ${h(RunControls, {})}
    <button type="button" class="button button-plain finder" aria-keyshortcuts="Control+K" onClick=${() => openPalette()}>
      ${h(Icon, { name: "search" })}<span>Search or command</span><kbd>Ctrl K</kbd>
    </button>
    ${openMapId.value && h(Button, { id: "exports", icon: "export", hint: "Save from this map: poses, floor plan, cloud, picture", onClick: showExports })}
    ${h(Button, {
      icon: theme.value === "dark" ? "light" : "dark",
      hint: theme.value === "dark" ? "Light theme (T)" : "Dark theme (T)",
      onClick: toggleTheme,
    })}
  </header>`;
}

function SessionState() {
  const now = session.value;
  if (!now) return null;
  if (now.map && now.map !== openMapId.value && now.state !== "idle") return h(ElsewhereState, { now, map: now.map });
  const ate = now.map === openMapId.value ? now.ate_m : undefined;
  const shown = ate ?? info.value?.ate_m;
  return html`<div class="session" role="status" aria-live="off">
    ${now.map ? h(Progress, { now }) : openMapId.value && html`<span class="quiet">browsing</span>`}
    ${shown !== null && shown !== undefined &&
    html`<span class="quiet" title="Absolute trajectory error against ground truth, aligned">ATE ${text.length(shown)}</span>`}
  </div>`;
}

/** @param {{now: import("../store.js").Schemas["Session"]}} props */
function Progress({ now }) {
  const details = [
    now.state === "running" && `${text.fixed(now.fps, 1)} fps`,
    `node ${text.whole(now.nodes)}`,
    now.frames ? `frame ${text.whole(now.frame)} / ${text.whole(now.frames)}` : `frame ${text.whole(now.frame)}`,
  ];
  return html`<span class=${cx("run-state", `run-${now.state}`)} title=${now.message || now.source || ""}>
      <i class="dot" aria-hidden="true"></i>${STATE_WORDS[now.state]}
    </span>
    <span class="run-figures clip">${now.state === "starting" ? now.message : details.filter(Boolean).join(" · ")}</span>
    ${now.lost > 0 && html`<span class="lost" title="Frames that odometry could not track">${now.lost} lost</span>`}`;
}

/** @param {{now: import("../store.js").Schemas["Session"], map: string}} props */
function ElsewhereState({ now, map }) {
  return html`<div class="session">
    <span class=${`run-state run-${now.state}`}><i class="dot" aria-hidden="true"></i>${STATE_WORDS[now.state]}</span>
    <a class="clip" href=${link({ map })}>${map}</a>
  </div>`;
}

function RunControls() {
  const state = session.value?.state;
  if (state !== "running" && state !== "paused") return null;
  const paused = state === "paused";
  return html`<div class="run-controls" role="group" aria-label="Run">
    ${h(Button, {
      id: "run-toggle",
      label: paused ? "Resume" : "Pause",
      icon: paused ? "play" : "pause",
      hint: "Pause or resume the run (Space)",
      onClick: () => void command(paused ? "resume" : "pause"),
    })}
    ${h(Button, {
      id: "run-step",
      label: "Step",
      icon: "step",
      hint: "Go on by one frame and pause (.)",
      onClick: () => void command("step"),
    })}
    ${h(Button, {
      id: "run-stop",
      label: "Stop",
      icon: "stop",
      hint: "End the run and close the map",
      onClick: () => void command("stop"),
    })}
  </div>`;
}
