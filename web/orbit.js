// A camera that circles a point: drawing points with it, and finding the one that was drawn at a pixel.

/** @typedef {{points: Float32Array, colours: Uint8Array, count: number}} Cloud points: x y z of each, metres; colours: red green blue of each */

/**
 * @typedef {object} View
 * @property {number} yaw radians, where it looks to, about z
 * @property {number} pitch radians, downwards
 * @property {number} distance metres from the target
 * @property {[number, number, number]} target what it circles
 */

/** Focal length over the height of the picture. */
const FOCAL = 0.9;
const NEAR_M = 0.02;
const STEEPEST = 1.55;
/** Pixels of CSS around a click in which a point is looked for. */
export const REACH = 9;

/** As the node looks: from its base along x at the middle of what it saw. @param {Cloud} cloud @returns {View} */
export function firstView(cloud) {
  const middle = /** @type {[number, number, number]} */ ([0, 1, 2].map((axis) => median(cloud, axis)));
  const distance = Math.max(0.5, Math.hypot(...middle));
  return { yaw: Math.atan2(middle[1], middle[0]), pitch: Math.atan2(-middle[2], Math.hypot(middle[0], middle[1])), distance, target: middle };
}

/** @param {Cloud} cloud @param {number} axis */
function median({ points, count }, axis) {
  const values = Float32Array.from({ length: count }, (_, k) => points[3 * k + axis]).sort();
  return count ? values[count >> 1] : 0;
}

/** Axes of the camera in the frame of the points: to the right, downwards, ahead. @param {View} view */
function axes({ yaw, pitch }) {
  const [c, s, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return { right: [s, -c, 0], down: [-c * sp, -s * sp, -cp], ahead: [c * cp, s * cp, -sp] };
}

/**
 * Where a point is in the picture, pixels, and how far ahead; null behind the camera.
 * @param {View} view @param {number} width @param {number} height @param {ArrayLike<number>} point
 */
export function project(view, width, height, point) {
  const { right, down, ahead } = axes(view);
  const d = [0, 1, 2].map((axis) => point[axis] - view.target[axis]);
  const along = (/** @type {number[]} */ axis) => d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2];
  const depth = view.distance + along(ahead);
  if (depth < NEAR_M) return null;
  const scale = (FOCAL * height) / depth;
  return { x: width / 2 + scale * along(right), y: height / 2 + scale * along(down), depth };
}

/**
 * Draw all points, near ones larger and in front.
 * @param {ImageData} image
 * @param {Cloud} cloud
 * @param {View} view
 * @returns {Int32Array} which point is to be seen at each pixel, -1 for none
 */
export function drawCloud(image, { points, colours, count }, view) {
  const { width, height } = image;
  const { right, down, ahead } = axes(view);
  const [tx, ty, tz] = view.target;
  const depths = new Float32Array(width * height).fill(Infinity);
  const shown = new Int32Array(width * height).fill(-1);
  const focal = FOCAL * height;
  // About as many pixels as lie between the points of a depth camera.
  const size = Math.max(1, height / 240);
  for (let k = 0; k < count; k += 1) {
    const [x, y, z] = [points[3 * k] - tx, points[3 * k + 1] - ty, points[3 * k + 2] - tz];
    const depth = view.distance + x * ahead[0] + y * ahead[1] + z * ahead[2];
    if (depth < NEAR_M) continue;
    const u = width / 2 + (focal * (x * right[0] + y * right[1])) / depth;
    const v = height / 2 + (focal * (x * down[0] + y * down[1] + z * down[2])) / depth;
    const half = Math.min(6, Math.max(1, (size * view.distance) / depth));
    const [left, top] = [Math.max(0, Math.round(u - half)), Math.max(0, Math.round(v - half))];
    const [last, lowest] = [Math.min(width - 1, Math.round(u + half)), Math.min(height - 1, Math.round(v + half))];
    for (let row = top; row <= lowest; row += 1) {
      for (let at = row * width + left; at <= row * width + last; at += 1) {
        if (depth < depths[at]) [depths[at], shown[at]] = [depth, k];
      }
    }
  }
  const pixels = new Uint32Array(image.data.buffer);
  for (let at = 0; at < shown.length; at += 1) {
    const k = 3 * shown[at];
    pixels[at] = k < 0 ? 0 : 0xff000000 | (colours[k + 2] << 16) | (colours[k + 1] << 8) | colours[k];
  }
  return shown;
}

/**
 * The point that is to be seen nearest to a pixel, -1 where there is none within reach.
 * @param {Int32Array} shown @param {number} width @param {number} x @param {number} y @param {number} reach
 */
export function pointNear(shown, width, x, y, reach) {
  const height = shown.length / width;
  let [found, least] = [-1, reach * reach];
  for (let row = Math.max(0, Math.ceil(y - reach)); row <= Math.min(height - 1, y + reach); row += 1) {
    for (let column = Math.max(0, Math.ceil(x - reach)); column <= Math.min(width - 1, x + reach); column += 1) {
      const far = (column - x) ** 2 + (row - y) ** 2;
      if (far <= least && shown[row * width + column] >= 0) [found, least] = [shown[row * width + column], far];
    }
  }
  return found;
}

/** @param {View} view @param {number} yaw @param {number} pitch radians @returns {View} */
export function turned(view, yaw, pitch) {
  return { ...view, yaw: view.yaw + yaw, pitch: Math.max(-STEEPEST, Math.min(STEEPEST, view.pitch + pitch)) };
}

/** @param {View} view @param {number} right @param {number} down shares of the height of the picture @returns {View} */
export function shifted(view, right, down) {
  const at = axes(view);
  const by = (view.distance / FOCAL) * -1;
  const target = view.target.map((value, axis) => value + by * (right * at.right[axis] + down * at.down[axis]));
  return { ...view, target: /** @type {[number, number, number]} */ (target) };
}

/** @param {View} view @param {number} factor of the distance @returns {View} */
export function zoomed(view, factor) {
  return { ...view, distance: Math.max(0.05, Math.min(500, view.distance * factor)) };
}
