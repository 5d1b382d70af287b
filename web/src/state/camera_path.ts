// The camera path between key frames as `skyquilt render --path` makes it (products/camera_path_file.cpp): positions on a uniform Catmull-Rom curve,
// rotations the shorter way, fields of view across the width linearly. Every section has the same number of frames, so it takes the same time.
import type { Vec2, Vec3 } from "../base/vec.js";
import { add, angleBetweenRad, dot, norm, scale, slerp, sub } from "../base/vec_math.js";
import { forward } from "../geo/camera.js";
import type { CameraPath, CameraPose, KeyFrame } from "./app_state.js";

/** Width by height of the video: products.video_width and products.video_height as they are preset. */
export const VIDEO_ASPECT = 16 / 9;
/** products.video_fps as it is preset. */
export const VIDEO_FPS = 12;
export const MOST_FRAMES_BETWEEN = 10000;
export const SLOWEST_MPS = 0.01;
export const FASTEST_MPS = 1000;
/** A camera that only turns has no speed in metres: it turns at most this fast. */
const FASTEST_TURN_RAD_PER_S = Math.PI / 6;
const SHORTEST_SECTION_S = 0.1;
const CURVE_PARTS = 32;
const RAD_PER_DEG = Math.PI / 180;

export function fovAcrossDeg(fovyDeg: number, aspect: number): number {
  return (2 * Math.atan(Math.tan((fovyDeg * RAD_PER_DEG) / 2) * aspect)) / RAD_PER_DEG;
}

export function fovyOfAcrossDeg(fovDeg: number, aspect: number): number {
  return (2 * Math.atan(Math.tan((fovDeg * RAD_PER_DEG) / 2) / aspect)) / RAD_PER_DEG;
}

/** At b for u = 0 and at c for u = 1. */
function catmullRom(a: Vec3, b: Vec3, c: Vec3, d: Vec3, u: number): Vec3 {
  const axis = (i: 0 | 1 | 2) =>
    0.5 *
    (2 * b[i] +
      u * (c[i] - a[i]) +
      u * u * (2 * a[i] - 5 * b[i] + 4 * c[i] - d[i]) +
      u * u * u * (3 * b[i] - 3 * c[i] + d[i] - a[i]));
  return [axis(0), axis(1), axis(2)];
}

/** Position in section `i`, which leads from key i to key i + 1. */
function eyeIn(keys: readonly KeyFrame[], i: number, u: number): Vec3 {
  const at = (k: number): Vec3 => keys[Math.min(keys.length - 1, Math.max(0, k))]?.pose.eyeEnu ?? [0, 0, 0];
  return catmullRom(at(i - 1), at(i), at(i + 1), at(i + 2), u);
}

/** The camera at `t` sections from the first key, 0 to keys - 1; null without keys. */
export function poseOnPath(keys: readonly KeyFrame[], t: number): CameraPose | null {
  const last = keys.length - 1;
  const place = Math.min(last, Math.max(0, Number.isFinite(t) ? t : 0));
  const i = Math.min(Math.max(0, last - 1), Math.floor(place));
  const from = keys[i]?.pose;
  const to = keys[Math.min(last, i + 1)]?.pose;
  if (from === undefined || to === undefined) return null;
  const u = place - i;
  const fov = (1 - u) * fovAcrossDeg(from.fovyDeg, VIDEO_ASPECT) + u * fovAcrossDeg(to.fovyDeg, VIDEO_ASPECT);
  return {
    eyeEnu: eyeIn(keys, i, u),
    rotation: slerp(from.rotation, to.rotation, u),
    fovyDeg: fovyOfAcrossDeg(fov, VIDEO_ASPECT),
    orthoHeightM: null,
  };
}

/** Length of the curve, metres. */
export function pathLengthM(keys: readonly KeyFrame[]): number {
  let length = 0;
  for (let i = 0; i + 1 < keys.length; i += 1) {
    let before = eyeIn(keys, i, 0);
    for (let k = 1; k <= CURVE_PARTS; k += 1) {
      const next = eyeIn(keys, i, k / CURVE_PARTS);
      length += norm(sub(next, before));
      before = next;
    }
  }
  return length;
}

/** Seconds of one section: by the speed over the whole path, longer when the camera would turn too fast. 0 with fewer than two keys. */
export function sectionSeconds({ keys, speedMps }: CameraPath): number {
  const sections = keys.length - 1;
  if (sections < 1) return 0;
  const speed = Math.min(FASTEST_MPS, Math.max(SLOWEST_MPS, Number.isFinite(speedMps) ? speedMps : 1));
  let turnRad = 0;
  for (let i = 0; i < sections; i += 1) {
    const from = keys[i]?.pose;
    const to = keys[i + 1]?.pose;
    if (from !== undefined && to !== undefined)
      turnRad = Math.max(turnRad, angleBetweenRad(from.rotation, to.rotation));
  }
  return Math.max(SHORTEST_SECTION_S, pathLengthM(keys) / speed / sections, turnRad / FASTEST_TURN_RAD_PER_S);
}

export function pathSeconds(path: CameraPath): number {
  return sectionSeconds(path) * Math.max(0, path.keys.length - 1);
}

/** Frames between two key frames of the video. */
export function framesBetween(path: CameraPath, fps = VIDEO_FPS): number {
  return Math.min(MOST_FRAMES_BETWEEN, Math.max(0, Math.round(sectionSeconds(path) * fps) - 1));
}

/**
 * The perspective camera that shows at `depthM` ahead as much as the orthographic one: `render --path` knows no other. A perspective pose stays.
 */
export function perspectivePose(pose: CameraPose, depthM: number | null): CameraPose {
  if (pose.orthoHeightM === null) return pose;
  const fovyDeg = pose.fovyDeg >= 10 && pose.fovyDeg <= 100 ? pose.fovyDeg : 45;
  const awayM = pose.orthoHeightM / 2 / Math.tan((fovyDeg * RAD_PER_DEG) / 2);
  const ahead = depthM !== null && Number.isFinite(depthM) && depthM > 0 ? depthM : awayM;
  return {
    eyeEnu: add(pose.eyeEnu, scale(forward(pose.rotation), ahead - awayM)),
    rotation: pose.rotation,
    fovyDeg,
    orthoHeightM: null,
  };
}

/** The part of the scene that this needs (scene/scene_api.ts). */
export interface PoseSource {
  readonly canvas: { readonly clientWidth: number; readonly clientHeight: number };
  pose(): CameraPose;
  pickSurface(px: Vec2): { readonly enu: Vec3 } | null;
}

/** The view as it is now, for a key frame. */
export function keyPose(scene: PoseSource): CameraPose {
  const pose = scene.pose();
  if (pose.orthoHeightM === null) return pose;
  const middle = scene.pickSurface([scene.canvas.clientWidth / 2, scene.canvas.clientHeight / 2]);
  return perspectivePose(pose, middle === null ? null : dot(sub(middle.enu, pose.eyeEnu), forward(pose.rotation)));
}

/** The keys in another order: the one at `from` comes to stand at `to`. */
export function movedKey(keys: readonly KeyFrame[], from: number, to: number): readonly KeyFrame[] {
  const key = keys[from];
  if (key === undefined || to < 0 || to >= keys.length || from === to) return keys;
  const others = keys.filter((_, i) => i !== from);
  return [...others.slice(0, to), key, ...others.slice(to)];
}
