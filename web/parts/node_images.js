// Colour and depth of a node side by side; each opens as large as the window. The pixel under the pointer is told of.
import { useRef, useState } from "preact/hooks";
import { h, html } from "../html.js";
import { address } from "../api.js";
import { colouredAddress, depthAddress, secondOf, secondsOf } from "../depth_look.js";
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
      <button type="button" class="picture-large" title="Larger" onClick=${() => setLarge("depth")}>${depth}${isAligned(node) && h(Cross, { node: node.id })}</button>
    </div>
    ${line}
    <figcaption class="picture-bar">
      ${h(KeyPointsToggle, { node, features })}<span class="grow"></span>
      ${(node.has_image || node.has_depth) && h(Button, { icon: "export", hint: "Save both pictures as PNG", kind: "bare", onClick: () => saveShown(pictures.current, `node ${node.id}`) })}
    </figcaption>
    ${(node.has_depth || node.has_right) && h(DepthLook, { seconds: secondsOf(node) })}
    ${large && h(Lightbox, { title: `Node ${node.id}, ${large === "depth" ? secondOf(node) : large}`, aspect: width / height, close, children: html`<div>${large === "colour" ? colour : depth}${line}</div>` })}
  </figure>`;
}

/** Whether the second picture has the pixels of the first. @param {NodeDetail} node */
export function isAligned(node) {
  return secondOf(node) !== "right";
}

/** What the second picture is. @param {NodeDetail} node */
function besides(node) {
  if (node.has_right) return `Left image, ${SECOND_NAMES[secondOf(node)]}; point at a pixel for its depth`;
  return node.has_depth ? "Point at a pixel for its depth" : "No depth is stored";
}

const SECOND_NAMES = /** @type {Record<string, string>} */ ({ right: "right image", disparity: "disparity", depth: "depth of the pair" });

/**
 * Depth and how sure the camera was of it, or what there is of a stereo pair: the right image, disparity, depth.
 * @param {{map: string, node: NodeDetail, onPoint?: OnPoint}} props
 */
export function SecondPicture({ map, node, onPoint }) {
  const second = secondOf(node);
  if (second === "right") return h(Second, { name: "Right image", id: node.id, source: address("api", "maps", map, "nodes", node.id, "right") });
  if (second === "disparity") return h(Second, { name: "Disparity", id: node.id, source: colouredAddress(map, node.id, second), onPoint });
  if (second === "confidence") return h(Second, { name: "Confidence of depth", id: node.id, source: colouredAddress(map, node.id, second), onPoint });
  return h(Second, { name: "Depth image", id: node.id, source: node.has_depth || node.has_right ? depthAddress(map, node.id) : null, onPoint });
}

/** @param {{name: string, id: number, source: string | null, onPoint?: OnPoint}} props */
function Second({ name, id, source, onPoint }) {
  const { image, missing } = useImage(source);
  if (!source) return html`<div class="picture-none quiet">No ${name.toLowerCase()} is stored.</div>`;
  if (missing) return html`<div class="picture-none quiet">The ${name.toLowerCase()} can't be shown: it is none, or damaged.</div>`;
  return h(Canvas, {
    label: `${name} of node ${id}`,
    aspect: image ? image.naturalWidth / image.naturalHeight : 4 / 3,
    dependencies: [image],
    pixels: image?.naturalWidth,
    onPoint,
    draw: (ctx, width, height) => image && ctx.drawImage(image, 0, 0, width, height),
  });
}
