// What a drag, the wheel and keys do to a camera pose, as pure functions. Everything in ENU and CSS pixels.
import type { Vec2, Vec3 } from "../base/vec.js";
import { add, norm, quatConjugate, quatMultiply, quatRotate, scale, sub } from "../base/vec_math.js";
import { anglesOfPose, forward, right, rotationFromAngles } from "../geo/camera.js";
import type { CameraPose } from "../state/app_state.js";
import { halfHeight, rayAt, type Size } from "./view_math.js";
import type { World } from "./world.js";

const RAD_PER_DEG = Math.PI / 180;
/** Rays flatter than this do not say where on the ground they end. */
const FLATTEST = 0.03;
export const STEEPEST_PITCH_DEG = -90;
export const FLATTEST_PITCH_DEG = -5;
const NEAREST_M = 0.3;
const LEAST_ORTHO_HEIGHT_M = 0.5;

/** Where the ray at `px` meets the horizontal plane at height z; null: nowhere ahead, or too far to be useful. */
export function onPlane(
  pose: CameraPose,
  size: Size,
  px: Vec2,
  z: number,
  farthestM = Number.POSITIVE_INFINITY,
): Vec3 | null {
  const ray = rayAt(pose, size, px);
  if (Math.abs(ray.direction[2]) < FLATTEST) return null;
  const t = (z - ray.originEnu[2]) / ray.direction[2];
  return t > 0 && t <= farthestM ? add(ray.originEnu, scale(ray.direction, t)) : null;
}

/** Moves horizontally, so that the grabbed place is under `px`. */
export function panTo(pose: CameraPose, size: Size, grabbed: Vec3, px: Vec2): CameraPose {
  const reach = 5 * norm(sub(grabbed, pose.eyeEnu)) + 1;
  const there = onPlane(pose, size, px, grabbed[2], pose.orthoHeightM === null ? reach : Number.POSITIVE_INFINITY);
  if (there === null) return pose;
  const by = sub(grabbed, there);
  return { ...pose, eyeEnu: [pose.eyeEnu[0] + by[0], pose.eyeEnu[1] + by[1], pose.eyeEnu[2]] };
}

/** Moves horizontally by pixels of the picture: right and up, where `distanceM` is that of the scene. */
export function panBy(pose: CameraPose, size: Size, byPx: Vec2, distanceM: number): CameraPose {
  const metres = (pose.orthoHeightM ?? 2 * halfHeight(pose) * distanceM) / Math.max(1, size[1]);
  const yaw = anglesOfPose(pose.rotation).yawDeg * RAD_PER_DEG;
  const [dx, dy] = [byPx[0] * metres, byPx[1] * metres];
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  return { ...pose, eyeEnu: [pose.eyeEnu[0] + c * dx + s * dy, pose.eyeEnu[1] - s * dx + c * dy, pose.eyeEnu[2]] };
}

/** Nearer to the place (factor below 1) or away from it; it keeps its pixel. */
export function zoomAt(pose: CameraPose, place: Vec3, factor: number, world: World): CameraPose {
  const away = sub(pose.eyeEnu, place);
  if (pose.orthoHeightM !== null) {
    const height = Math.min(6 * world.sizeM, Math.max(LEAST_ORTHO_HEIGHT_M, pose.orthoHeightM * factor));
    const ratio = height / pose.orthoHeightM;
    const eyeEnu: Vec3 = [place[0] + away[0] * ratio, place[1] + away[1] * ratio, pose.eyeEnu[2]];
    return { ...pose, orthoHeightM: height, eyeEnu };
  }
  const distance = norm(away);
  if (!(distance > 0)) return pose;
  const wanted = Math.min(Math.max(distance * factor, NEAREST_M), Math.max(distance, 6 * world.sizeM));
  return { ...pose, eyeEnu: add(place, scale(away, wanted / distance)) };
}

/** Turns about a place: heading by dYaw, then up or down by dPitch; both degrees. The place keeps its pixel, the horizon stays level. */
export function orbit(pose: CameraPose, pivot: Vec3, dYawDeg: number, dPitchDeg: number): CameraPose {
  const turned = turn(pose, dYawDeg, dPitchDeg, FLATTEST_PITCH_DEG);
  // From the old camera axes to the new ones, seen in ENU.
  const change = quatMultiply(quatConjugate(turned.rotation), levelled(pose).rotation);
  return { ...turned, eyeEnu: add(pivot, quatRotate(change, sub(pose.eyeEnu, pivot))) };
}

/** Looks elsewhere from the same place. Pitch ends at straight down and at `highestDeg`. */
export function turn(pose: CameraPose, dYawDeg: number, dPitchDeg: number, highestDeg = 89): CameraPose {
  const angles = anglesOfPose(pose.rotation);
  // A view from above the limit, a photo's say, may only come down to it.
  const highest = Math.max(highestDeg, angles.pitchDeg);
  const pitchDeg = Math.min(highest, Math.max(STEEPEST_PITCH_DEG, angles.pitchDeg + dPitchDeg));
  const rotation = rotationFromAngles({ yawDeg: angles.yawDeg + dYawDeg, pitchDeg, rollDeg: 0 });
  return { ...pose, rotation };
}

/** The same direction with a level horizon. */
export function levelled(pose: CameraPose): CameraPose {
  return turn(pose, 0, 0, 90);
}

/** Metres along the camera's own right and ahead and along z. */
export function flyBy(pose: CameraPose, rightM: number, aheadM: number, upM: number): CameraPose {
  const by = add(scale(right(pose.rotation), rightM), scale(forward(pose.rotation), aheadM));
  return { ...pose, eyeEnu: add(pose.eyeEnu, [by[0], by[1], by[2] + upM]) };
}

/** Not farther out than a few times the scene. */
export function keepNear(pose: CameraPose, world: World): CameraPose {
  const reach = 8 * world.sizeM + 100;
  const clamp = (value: number, low: number, high: number) => Math.min(high + reach, Math.max(low - reach, value));
  const { min, max } = world.boxEnu;
  const [x, y, z] = pose.eyeEnu;
  const eyeEnu: Vec3 = [clamp(x, min[0], max[0]), clamp(y, min[1], max[1]), clamp(z, min[2], max[2])];
  return eyeEnu.every((value, i) => value === pose.eyeEnu[i]) ? pose : { ...pose, eyeEnu };
}
