// A still picture seen by a camera of the same place and direction whose field of view or picture has another size: it is scaled and cut about its middle.
import { type DepthPicture, focalPx, type PerspectiveView } from "./panorama.js";

type Frame = Pick<PerspectiveView, "fovyDeg" | "width" | "height">;

/** Where the view lies in the still, in its pixels. */
export interface Reframing {
  readonly left: number;
  readonly top: number;
  /** Pixels of the still per pixel of the view. */
  readonly scale: number;
}

/** Half a pixel at the rim need not be filled. */
const RIM_PX = 0.5;

export function reframing(still: Frame, view: Frame): Reframing {
  const scale = focalPx(still) / focalPx(view);
  return { left: (still.width - scale * view.width) / 2, top: (still.height - scale * view.height) / 2, scale };
}

/** The still fills the view. */
export function fills(still: Frame, view: Frame): boolean {
  const { left, top } = reframing(still, view);
  return left >= -RIM_PX && top >= -RIM_PX;
}

/** Depth of the view from that of the still: the nearest value, NaN beyond the rim. */
export function reframedDepth(still: Frame, depth: DepthPicture, view: Frame): DepthPicture {
  const { left, top, scale } = reframing(still, view);
  const width = Math.ceil(view.width / 2);
  const height = Math.ceil(view.height / 2);
  const depthM = new Float32Array(width * height).fill(Number.NaN);
  // Of the value nearest to the middle of the view's pixel 2i; -1: beyond the rim.
  const nearest = (begin: number, i: number, pixels: number, values: number): number => {
    const x = begin + (2 * i + 0.5) * scale;
    return x <= -RIM_PX || x >= pixels + RIM_PX ? -1 : Math.min(values - 1, Math.max(0, Math.floor(x / 2 + 0.25)));
  };
  const columns = Array.from({ length: width }, (_, i) => nearest(left, i, still.width, depth.width));
  for (let j = 0; j < height; j += 1) {
    const row = nearest(top, j, still.height, depth.height);
    if (row < 0) continue;
    for (const [i, column] of columns.entries()) {
      if (column >= 0) depthM[j * width + i] = depth.depthM[row * depth.width + column] ?? Number.NaN;
    }
  }
  return { width, height, depthM };
}
