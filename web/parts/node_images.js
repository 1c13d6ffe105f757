// Colour and depth of a node side by side; each opens as large as the window. The pixel under the pointer is told of.
import { useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { address } from "../api.js";
import { depthAddress } from "../depth_look.js";
import { pointAt } from "../pointed.js";
import { Button } from "./button.js";
import { Canvas, useImage } from "./canvas.js";
import { DepthLook } from "./depth_bar.js";
import { ColourPicture, KeyPointsToggle, useKeyPoints } from "./keypoints.js";
import { Lightbox, saveShown } from "./lightbox.js";
import { Cross, PixelLine, imageSize } from "./pixel.js";

/** @typedef {import("../store.js").Schemas["NodeDetail"]} NodeDetail */
/** @typedef {(place: import("./canvas.js").Place | null) => void} OnPoint */

/** @param {{map: string, node: NodeDetail}} props */
export function NodeImages({ map, node }) {
  const [large, setLarge] = useState(/** @type {"colour" | "depth" | null} */ (null));
  const pictures = useRef(/** @type {HTMLElement | null} */ (null));
  const features = useKeyPoints(map, node);
  const onPoint = (/** @type {import("./canvas.js").Place | null} */ place) => pointAt(map, node, place);
  const colour = h(ColourPicture, { map, node, features, onPoint });
  const depth = h(SecondPicture, { map, node, onPoint });
  const line = h(PixelLine, { node, features, quiet: besides(node) });
  const close = () => (setLarge(null), onPoint(null));
  const [width, height] = imageSize(node) ?? [4, 3];
  return html`<figure class="picture">
    <div class="pictures" ref=${pictures}>
      <button type="button" class="picture-large" title="Larger" onClick=${() => setLarge("colour")}>${colour}${h(Cross, { node: node.id })}</button>
      <button type="button" class="picture-large" title="Larger" onClick=${() => setLarge("depth")}>${depth}${h(Cross, { node: node.id })}</button>
    </div>
    ${line}
    <figcaption class="picture-bar">
      ${h(KeyPointsToggle, { node, features })}<span class="grow"></span>
      ${(node.has_image || node.has_depth) && h(Button, { icon: "export", hint: "Save both pictures as PNG", kind: "bare", onClick: () => saveShown(pictures.current, `node ${node.id}`) })}
    </figcaption>
    ${node.has_depth && h(DepthLook, {})}
    ${large && h(Lightbox, { title: `Node ${node.id}, ${large}`, aspect: width / height, close, children: html`<div>${large === "colour" ? colour : depth}${line}</div>` })}
  </figure>`;
}

/** What the second picture is. @param {NodeDetail} node */
function besides({ has_right, has_depth }) {
  if (has_right) return "Left and right image of the stereo camera";
  return has_depth ? "Point at a pixel for its depth" : "No depth is stored";
}

/** Depth, or the right image of a stereo pair. @param {{map: string, node: NodeDetail, onPoint?: OnPoint}} props */
export function SecondPicture({ map, node, onPoint }) {
  return node.has_right ? h(RightPicture, { map, node, onPoint }) : h(DepthPicture, { map, node, onPoint });
}

/** @param {{map: string, node: NodeDetail, onPoint?: OnPoint}} props */
function RightPicture({ map, node }) {
  const { image } = useImage(address("api", "maps", map, "nodes", node.id, "right"));
  return h(Canvas, {
    label: `Right image of node ${node.id}`,
    aspect: image ? image.naturalWidth / image.naturalHeight : 4 / 3,
    dependencies: [image],
    pixels: image?.naturalWidth,
    draw: (ctx, width, height) => image && ctx.drawImage(image, 0, 0, width, height),
  });
}

/** @param {{map: string, node: NodeDetail, onPoint?: OnPoint}} props */
function DepthPicture({ map, node, onPoint }) {
  const { image, missing } = useImage(node.has_depth ? depthAddress(map, node.id) : null);
  if (!node.has_depth) return html`<div class="picture-none quiet">No depth image is stored.</div>`;
  if (missing) return html`<div class="picture-none quiet">The depth image can't be shown: it is none, or damaged.</div>`;
  return h(Canvas, {
    label: `Depth image of node ${node.id}`,
    aspect: image ? image.naturalWidth / image.naturalHeight : 4 / 3,
    dependencies: [image],
    pixels: image?.naturalWidth,
    onPoint,
    draw: (ctx, width, height) => image && ctx.drawImage(image, 0, 0, width, height),
  });
}
