// Rays and places of a camera pose, in doubles and without three.js: x right, y down, z ahead, as the engine sees it. Canvas positions are CSS pixels
// from the upper left corner.
import type { Vec2, Vec3 } from "../base/vec.js";
import { add, dot, normalize, scale, sub } from "../base/vec_math.js";
import { forward, right, up } from "../geo/camera.js";
import type { CameraPose } from "../state/app_state.js";
import type { Ray } from "./scene_api.js";
import type { Box } from "./world.js";

/** Width and height of the canvas. */
export type Size = Vec2;

const RAD_PER_DEG = Math.PI / 180;

/** Half the picture's height at distance 1 (perspective). */
export function halfHeight(pose: CameraPose): number {
  return Math.tan((pose.fovyDeg * RAD_PER_DEG) / 2);
}

export function rayAt(pose: CameraPose, size: Size, px: Vec2): Ray {
  const height = Math.max(1, size[1]);
  const [ahead, aside, above] = [forward(pose.rotation), right(pose.rotation), up(pose.rotation)];
  const across = px[0] - size[0] / 2;
  const along = size[1] / 2 - px[1];
  if (pose.orthoHeightM !== null) {
    const pixelM = pose.orthoHeightM / height;
    const originEnu = add(pose.eyeEnu, add(scale(aside, across * pixelM), scale(above, along * pixelM)));
    return { originEnu, direction: ahead, pixelPitch: 0, pixelWidthM: pixelM };
  }
  const pitch = (2 * halfHeight(pose)) / height;
  const direction = normalize(add(ahead, add(scale(aside, across * pitch), scale(above, along * pitch))));
  return { originEnu: pose.eyeEnu, direction, pixelPitch: pitch, pixelWidthM: 0 };
}

/** x to the right, y down, z ahead of the eye, metres. */
export function cameraFromEnu(pose: CameraPose, point: Vec3): Vec3 {
  const d = sub(point, pose.eyeEnu);
  return [dot(right(pose.rotation), d), -dot(up(pose.rotation), d), dot(forward(pose.rotation), d)];
}

/** Canvas position of a place in the camera's frame; its z must be positive in perspective. */
export function pixelOf(pose: CameraPose, size: Size, inCamera: Vec3): Vec2 {
  const focal =
    pose.orthoHeightM === null
      ? size[1] / (2 * halfHeight(pose)) / inCamera[2]
      : size[1] / Math.max(1e-9, pose.orthoHeightM);
  return [size[0] / 2 + inCamera[0] * focal, size[1] / 2 + inCamera[1] * focal];
}

/** Null: behind the camera. */
export function projectPoint(pose: CameraPose, size: Size, point: Vec3): Vec2 | null {
  const inCamera = cameraFromEnu(pose, point);
  if (!(inCamera[2] > 1e-6)) return null;
  const px = pixelOf(pose, size, inCamera);
  return Number.isFinite(px[0]) && Number.isFinite(px[1]) ? px : null;
}

/** Metres of the scene per CSS pixel at a distance along the optical axis. */
export function pixelSizeM(pose: CameraPose, size: Size, depthM: number): number {
  const height = Math.max(1, size[1]);
  return pose.orthoHeightM !== null ? pose.orthoHeightM / height : (2 * halfHeight(pose) * depthM) / height;
}

export function cornersOf(box: Box): Vec3[] {
  const corners: Vec3[] = [];
  for (const x of [box.min[0], box.max[0]]) {
    for (const y of [box.min[1], box.max[1]]) {
      for (const z of [box.min[2], box.max[2]]) corners.push([x, y, z]);
    }
  }
  return corners;
}

/**
 * Near and far that hold the box. Near is as far out as the box and the precision of 24-bit depth allow, but never so far that a surface close to
 * the camera is cut away.
 */
export function depthRange(pose: CameraPose, box: Box): { readonly near: number; readonly far: number } {
  const depths = cornersOf(box).map((corner) => cameraFromEnu(pose, corner)[2]);
  const nearest = Math.min(...depths);
  const farthest = Math.max(...depths);
  if (pose.orthoHeightM !== null) return { near: nearest - 1, far: Math.max(nearest, farthest) + 1 };
  const far = Math.max(2, farthest * 1.01 + 1);
  const least = Math.min(2, Math.max(0.05, far / 20_000));
  return { near: Math.max(least, Math.min(nearest * 0.98, far * 0.9)), far };
}
