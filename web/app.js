// The page: three areas and a strip, put together once.
import { render } from "preact";
import { useEffect } from "preact/hooks";
import { cx, h, html } from "./html.js";
import { connect } from "./events.js";
import { makeFirstCanvas } from "./first_canvas.js";
import { startKeys } from "./keys.js";
import { Banners, Toasts } from "./parts/banner.js";
import { Exports } from "./parts/exports.js";
import { Help } from "./parts/help.js";
import { Palette } from "./parts/palette.js";
import { Rail } from "./parts/rail.js";
import { SceneView } from "./parts/scene.js";
import { Splitter } from "./parts/splitter.js";
import { Strip } from "./parts/strip.js";
import { TimelineBar } from "./parts/timeline.js";
import { TopBar } from "./parts/topbar.js";
import { Tour } from "./parts/tour.js";
import { remembered } from "./prefs.js";
import { route, startRouter } from "./router.js";
import { startLanding } from "./landing.js";
import { startMoment } from "./moment.js";
import { startPicking } from "./picking.js";
import { startStore } from "./store.js";
import { startTrials } from "./trials.js";
import { startTheme } from "./theme.js";
import { startOptimising } from "./optimising.js";
import { startWeights } from "./weights.js";
import { GraphView } from "./views/graph.js";
import { Loops } from "./views/loops.js";
import { Maps } from "./views/maps.js";
import { Nodes } from "./views/nodes.js";
import { Params } from "./views/params.js";
import { Stats } from "./views/stats.js";

const VIEWS = { maps: Maps, nodes: Nodes, loops: Loops, params: Params, stats: Stats, graph: GraphView };

const panelWidth = remembered("panel-width", 452);
const stripHeight = remembered("strip-height", 148);

function App() {
  const { view, map } = route.value;
  useEffect(() => {
    document.title = map ? `${map} · slamdeck` : "slamdeck";
  }, [map]);
  return html`<div class="page">
    ${h(TopBar, {})}${h(Banners, {})}
    <div class="work">
      ${h(Rail, {})}
      ${map && h(Middle, {})}
      <main class=${cx("panel", !map && "panel-alone")} style=${{ width: map ? `${panelWidth.value}px` : "auto" }} aria-label=${view}>
        ${h(VIEWS[view], { key: `${map}/${view}` })}
      </main>
    </div>
    ${h(Palette, {})}${h(Help, {})}${h(Exports, {})}${h(Toasts, {})}${h(Tour, {})}
  </div>`;
}

/** The open map in 3D and its charts; without a map the list of maps has all the room. */
function Middle() {
  return html`<section class="middle" aria-label="The open map">
    ${h(SceneView, {})}
    <div class="strip-area" style=${{ height: `${stripHeight.value}px` }}>
      ${h(Splitter, { label: "Height of the charts", orientation: "horizontal", size: stripHeight, min: 90, max: () => innerHeight * 0.5 })}
      ${h(Strip, {})}
    </div>
    ${h(TimelineBar, {})}
    ${h(Splitter, { label: "Width of the panel", orientation: "vertical", size: panelWidth, min: 380, max: () => innerWidth * 0.6 })}
  </section>`;
}

makeFirstCanvas();
startTheme();
startRouter();
startStore();
startTrials();
startMoment();
startLanding();
startPicking();
startWeights();
startOptimising();
startKeys();
connect();
render(h(App, {}), /** @type {HTMLElement} */ (document.getElementById("app")));
