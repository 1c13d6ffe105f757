// Colour and depth of a node side by side; each opens as large as the window.
import { useState } from "preact/hooks";
import { h, html } from "../html.js";
import { address } from "../api.js";
import { Canvas, useImage } from "./canvas.js";
import { ColourPicture, KeyPointsToggle, useKeyPoints } from "./keypoints.js";
import { Lightbox } from "./lightbox.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */

/** @param {{map: string, node: NodeDetail}} props */
export function NodeImages({ map, node }) {
  const [large, setLarge] = useState(/** @type {"colour" | "depth" | null} */ (null));
  const features = useKeyPoints(map, node);
  const colour = h(ColourPicture, { map, node, features });
  const depth = node.has_right ? h(RightPicture, { map, node }) : h(DepthPicture, { map, node });
  const close = () => setLarge(null);
  return html`<figure class="picture">
    <div class="pictures">
      <button type="button" class="picture-large" title="Larger" onClick=${() => setLarge("colour")}>${colour}</button>
      <button type="button" class="picture-large" title="Larger" onClick=${() => setLarge("depth")}>${depth}</button>
    </div>
    <figcaption class="picture-bar">
      ${h(KeyPointsToggle, { node, features })}
      <span class="quiet small grow right">${besides(node)}</span>
    </figcaption>
    ${large && h(Lightbox, { title: `Node ${node.id}, ${large}`, close, children: large === "colour" ? colour : depth })}
  </figure>`;
}

/** What the second picture is. @param {NodeDetail} node */
function besides({ has_right, has_depth }) {
  if (has_right) return "left and right image of the stereo camera";
  return has_depth ? "depth from near (blue) to far (red)" : "";
}

/** @param {{map: string, node: NodeDetail}} props */
function RightPicture({ map, node }) {
  const { image } = useImage(address("api", "maps", map, "nodes", node.id, "right"));
  return h(Canvas, {
    label: `Right image of node ${node.id}`,
    aspect: image ? image.naturalWidth / image.naturalHeight : 4 / 3,
    dependencies: [image],
    draw: (ctx, width, height) => image && ctx.drawImage(image, 0, 0, width, height),
  });
}

/** @param {{map: string, node: NodeDetail}} props */
function DepthPicture({ map, node }) {
  const { image, missing } = useImage(node.has_depth ? address("api", "maps", map, "nodes", node.id, "depth.png") : null);
  if (!node.has_depth) return html`<div class="picture-none quiet">No depth image is stored.</div>`;
  if (missing) return html`<div class="picture-none quiet">The depth image can't be shown: it is none, or damaged.</div>`;
  return h(Canvas, {
    label: `Depth image of node ${node.id}`,
    aspect: image ? image.naturalWidth / image.naturalHeight : 4 / 3,
    dependencies: [image],
    draw: (ctx, width, height) => image && ctx.drawImage(image, 0, 0, width, height),
  });
}
