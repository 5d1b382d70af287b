// Perspective pictures from an equirectangular panorama (north in the middle, east to the right of it, the top row up), as seen from the same eye.
// Colours are mixed between the four nearest pixels, across the seam in the south and over the poles; depths are taken from the nearest one, as a mix
// over an edge would be the depth of nothing.
import type { Quat } from "../base/vec.js";
import { matrixFromQuat } from "../base/vec_math.js";

export interface PanoramaImage {
  /** Even; `height` is half of it. */
  readonly width: number;
  readonly height: number;
  /** Red, green, blue, alpha of each pixel, row by row. */
  readonly rgba: Uint8ClampedArray;
}

/** Depth pixel (i, j) belongs to colour pixel (2i, 2j). */
export interface PanoramaDepth {
  readonly width: number;
  readonly height: number;
  /** Metres along the ray; NaN: no surface. */
  readonly distanceM: Float32Array;
}

export interface PerspectiveView {
  /** cam_from_enu. */
  readonly rotation: Quat;
  /** Across the height. */
  readonly fovyDeg: number;
  readonly width: number;
  readonly height: number;
}

/** Depth pixel (i, j) belongs to colour pixel (2i, 2j) here too. */
export interface DepthPicture {
  readonly width: number;
  readonly height: number;
  /** z along the optical axis in metres; NaN: no surface. */
  readonly depthM: Float32Array;
}

/** Distance of the picture plane in pixels. */
export function focalPx({ fovyDeg, height }: Pick<PerspectiveView, "fovyDeg" | "height">): number {
  return height / 2 / Math.tan((fovyDeg * Math.PI) / 360);
}

/** Colours of the rows `fromRow` to `toRow` (exclusive) of the view, written to `rgba`, which holds the whole picture. */
export function drawRows(
  panorama: PanoramaImage,
  view: PerspectiveView,
  rgba: Uint8ClampedArray,
  fromRow: number,
  toRow: number,
): void {
  const { width: wide, height: high } = panorama;
  const source = panorama.rgba;
  const last = high - 1;
  const half = wide >> 1;
  const perTurn = wide / (2 * Math.PI);
  const perHalfTurn = high / Math.PI;
  eachRay(view, 1, fromRow, toRow, (east, north, up, at) => {
    const column = angleOf(east, north) * perTurn + (half - 0.5);
    const row = high / 2 - 0.5 - angleOf(up, Math.sqrt(east * east + north * north)) * perHalfTurn;
    const [c, r] = [Math.floor(column), Math.floor(row)];
    const [u, v] = [column - c, row - r];
    // Beyond a pole one comes down on the other side.
    const turnTop = r < 0 ? half : 0;
    const turnBottom = r >= last ? half : 0;
    const top = Math.max(r, 0) * wide;
    const bottom = Math.min(r + 1, last) * wide;
    const left = c + wide;
    const a = 4 * (top + ((left + turnTop) % wide));
    const b = 4 * (top + ((left + 1 + turnTop) % wide));
    const d = 4 * (bottom + ((left + turnBottom) % wide));
    const e = 4 * (bottom + ((left + 1 + turnBottom) % wide));
    const wa = (1 - u) * (1 - v);
    const wb = u * (1 - v);
    const wd = (1 - u) * v;
    const we = u * v;
    const out = 4 * at;
    for (let k = 0; k < 3; k += 1) {
      rgba[out + k] =
        wa * (source[a + k] ?? 0) + wb * (source[b + k] ?? 0) + wd * (source[d + k] ?? 0) + we * (source[e + k] ?? 0);
    }
    rgba[out + 3] = 255;
  });
}

/** Depth of the view at every second pixel of every second row. */
export function drawDepth(depth: PanoramaDepth, view: PerspectiveView): DepthPicture {
  const width = Math.ceil(view.width / 2);
  const height = Math.ceil(view.height / 2);
  const depthM = new Float32Array(width * height);
  const perTurn = depth.width / (2 * Math.PI);
  const perHalfTurn = depth.height / Math.PI;
  const half = depth.width / 2;
  eachRay(view, 2, 0, height, (east, north, up, at, length) => {
    // A depth pixel lies a quarter of its width left of and above its own middle.
    const column = Math.floor(angleOf(east, north) * perTurn + half + 0.25);
    const row = Math.floor(depth.height / 2 + 0.25 - angleOf(up, Math.sqrt(east * east + north * north)) * perHalfTurn);
    const c = (column + depth.width) % depth.width;
    const r = row < 0 ? 0 : row >= depth.height ? depth.height - 1 : row;
    depthM[at] = (depth.distanceM[r * depth.width + c] ?? Number.NaN) / length;
  });
  return { width, height, depthM };
}

type RayVisit = (east: number, north: number, up: number, at: number, length: number) => void;

/** Rays (not of length 1: their z along the optical axis is) through the middle of every `step`-th pixel; `at` counts them from the first row. */
function eachRay(view: PerspectiveView, step: number, fromRow: number, toRow: number, visit: RayVisit): void {
  const m = matrixFromQuat(view.rotation);
  const [xe = 0, xn = 0, xu = 0, ye = 0, yn = 0, yu = 0, ze = 0, zn = 0, zu = 0] = m;
  const focal = focalPx(view);
  const columns = Math.ceil(view.width / step);
  for (let j = fromRow; j < toRow; j += 1) {
    const y = (step * j + 0.5 - view.height / 2) / focal;
    const [e, n, u] = [y * ye + ze, y * yn + zn, y * yu + zu];
    for (let i = 0; i < columns; i += 1) {
      const x = (step * i + 0.5 - view.width / 2) / focal;
      visit(x * xe + e, x * xn + n, x * xu + u, j * columns + i, Math.sqrt(x * x + y * y + 1));
    }
  }
}

/** Math.atan2 to 2e-6 rad, which is a five-hundredth of a pixel of a panorama of 16384, in a third of the time. */
function angleOf(y: number, x: number): number {
  const [ax, ay] = [Math.abs(x), Math.abs(y)];
  const most = Math.max(ax, ay);
  if (most === 0) return 0;
  const t = Math.min(ax, ay) / most;
  const s = t * t;
  let angle =
    t * (0.99997726 + s * (-0.33262347 + s * (0.19354346 + s * (-0.11643287 + s * (0.05265332 - s * 0.0117212)))));
  if (ay > ax) angle = Math.PI / 2 - angle;
  if (x < 0) angle = Math.PI - angle;
  return y < 0 ? -angle : angle;
}
