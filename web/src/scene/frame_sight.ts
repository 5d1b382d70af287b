// How far one sees in an exact frame at a place of its picture. Pure.
import type { Vec2, Vec3 } from "../base/vec.js";
import { quatConjugate, quatRotate } from "../base/vec_math.js";
import type { ExactFrame } from "../protocol/link_api.js";
import type { Enu } from "../state/app_state.js";

export type FrameDepth = Pick<
  ExactFrame,
  "width" | "height" | "depthWidth" | "depthHeight" | "depthM" | "fovyDeg" | "orthoHeightM" | "eyeEnu" | "rotation"
>;

/** z along the optical axis at (u, v), 0 to 1 from the upper left corner; infinity: no surface. */
export function depthInFrame(frame: FrameDepth, [u, v]: Vec2): number {
  const { width, height, depthWidth, depthHeight, depthM } = frame;
  const sample = (part: number, pixels: number, samples: number) =>
    Math.min(samples - 1, Math.max(0, Math.floor(Math.floor(part * pixels) / 2)));
  const z = depthM[sample(v, height, depthHeight) * depthWidth + sample(u, width, depthWidth)] ?? Number.NaN;
  return Number.isFinite(z) ? z : Number.POSITIVE_INFINITY;
}

/** The place in ENU that is shown there, `z` ahead of the frame's eye. */
export function pointOfFrame(frame: FrameDepth, [u, v]: Vec2, z: number): Enu {
  const perspective = frame.orthoHeightM === null;
  const half = perspective ? z * Math.tan(((frame.fovyDeg ?? 60) * Math.PI) / 360) : frame.orthoHeightM / 2;
  const inCamera: Vec3 = [(2 * u - 1) * half * (frame.width / frame.height), (2 * v - 1) * half, z];
  const [x, y, up] = quatRotate(quatConjugate(frame.rotation), inCamera);
  return [frame.eyeEnu[0] + x, frame.eyeEnu[1] + y, frame.eyeEnu[2] + up];
}
