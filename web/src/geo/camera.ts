// Poses of cameras. rotation is cam_from_enu, w x y z, with COLMAP's camera axes (x right, y down, z ahead). Angles as in products/camera_path.h:
// yaw clockwise from north, pitch 0 level and -90 straight down, roll positive with the right side down.
import type { Quat, Vec3 } from "../base/vec.js";
import {
  cross,
  matrixFromQuat,
  quatConjugate,
  quatFromMatrix,
  quatMultiply,
  quatNormalize,
  slerp,
} from "../base/vec_math.js";

export interface Angles {
  readonly yawDeg: number;
  readonly pitchDeg: number;
  readonly rollDeg: number;
}
/** What a camera pose has (state/app_state.ts, CameraPose). */
export interface Pose {
  readonly eyeEnu: Vec3;
  readonly rotation: Quat;
  readonly fovyDeg: number;
  readonly orthoHeightM: number | null;
}

const RAD_PER_DEG = Math.PI / 180;
/** Half a turn about x: from COLMAP's camera axes (y down, z ahead) to those of three.js (y up, z back), and back. */
const FLIP: Quat = [0, 1, 0, 0];

/** Direction of view, in ENU. */
export function forward(rotation: Quat): Vec3 {
  const m = matrixFromQuat(rotation);
  return [m[6] ?? 0, m[7] ?? 0, m[8] ?? 0];
}

/** Direction in ENU that is to the right in the picture. */
export function right(rotation: Quat): Vec3 {
  const m = matrixFromQuat(rotation);
  return [m[0] ?? 0, m[1] ?? 0, m[2] ?? 0];
}

/** Direction in ENU that is up in the picture. */
export function up(rotation: Quat): Vec3 {
  const m = matrixFromQuat(rotation);
  return [-(m[3] ?? 0), -(m[4] ?? 0), -(m[5] ?? 0)];
}

/** The same as PoseFromAngles in products/camera_path.cpp. */
export function rotationFromAngles({ yawDeg, pitchDeg, rollDeg }: Angles): Quat {
  const [yaw, pitch, roll] = [yawDeg * RAD_PER_DEG, pitchDeg * RAD_PER_DEG, rollDeg * RAD_PER_DEG];
  const ahead: Vec3 = [Math.sin(yaw) * Math.cos(pitch), Math.cos(yaw) * Math.cos(pitch), Math.sin(pitch)];
  const level: Vec3 = [Math.cos(yaw), -Math.sin(yaw), 0];
  const below = cross(ahead, level);
  const c = Math.cos(roll);
  const s = Math.sin(roll);
  return quatFromMatrix([
    c * level[0] + s * below[0],
    c * level[1] + s * below[1],
    c * level[2] + s * below[2],
    c * below[0] - s * level[0],
    c * below[1] - s * level[1],
    c * below[2] - s * level[2],
    ...ahead,
  ]);
}

/** yaw in [0, 360), roll in (-180, 180]. Looking straight up or down, yaw and roll turn about the same axis: roll is 0 then. */
export function anglesOfPose(rotation: Quat): Angles {
  const ahead = forward(rotation);
  const side = right(rotation);
  const across = Math.hypot(ahead[0], ahead[1]);
  const pitch = Math.atan2(ahead[2], across);
  const steep = across < 1e-9;
  const yaw = steep ? Math.atan2(-side[1], side[0]) : Math.atan2(ahead[0], ahead[1]);
  const level: Vec3 = [Math.cos(yaw), -Math.sin(yaw), 0];
  const below = cross(ahead, level);
  const roll = steep
    ? 0
    : Math.atan2(side[0] * below[0] + side[1] * below[1] + side[2] * below[2], side[0] * level[0] + side[1] * level[1]);
  const yawDeg = yaw / RAD_PER_DEG;
  return {
    // A tiny negative angle plus 360 would be 360.
    yawDeg: yawDeg < 0 ? (yawDeg + 360) % 360 : yawDeg,
    pitchDeg: pitch / RAD_PER_DEG,
    rollDeg: roll / RAD_PER_DEG,
  };
}

/** Rotation of a camera at `eye` that looks at `target`, with a level horizon; north is up in the picture when it looks straight down. */
export function poseLookingAt(eye: Vec3, target: Vec3): Quat {
  const x = target[0] - eye[0];
  const y = target[1] - eye[1];
  const z = target[2] - eye[2];
  const across = Math.hypot(x, y);
  if (across === 0 && z === 0) return rotationFromAngles({ yawDeg: 0, pitchDeg: 0, rollDeg: 0 });
  const yaw = across > 1e-9 * Math.hypot(x, y, z) ? Math.atan2(x, y) : 0;
  return rotationFromAngles({ yawDeg: yaw / RAD_PER_DEG, pitchDeg: Math.atan2(z, across) / RAD_PER_DEG, rollDeg: 0 });
}

/** Quaternion x, y, z, w of a three.js camera with this view, in a scene whose axes are those of ENU. */
export function threeQuaternion(rotation: Quat): [number, number, number, number] {
  const [w, x, y, z] = quatMultiply(quatConjugate(rotation), FLIP);
  return [x, y, z, w];
}

/** The inverse of threeQuaternion. */
export function rotationFromThree(x: number, y: number, z: number, w: number): Quat {
  return quatNormalize(quatMultiply(FLIP, quatConjugate([w, x, y, z])));
}

/** From a (u = 0) to b (u = 1): eye on a straight line, rotation the shorter way, picture heights by a constant factor. */
export function interpolatePose(a: Pose, b: Pose, u: number): Pose {
  const mix = (from: number, to: number) => from + (to - from) * u;
  const both = a.orthoHeightM !== null && b.orthoHeightM !== null && a.orthoHeightM > 0 && b.orthoHeightM > 0;
  // Perspective and orthographic have no middle: it changes half way.
  const nearest = u < 0.5 ? a.orthoHeightM : b.orthoHeightM;
  return {
    eyeEnu: [mix(a.eyeEnu[0], b.eyeEnu[0]), mix(a.eyeEnu[1], b.eyeEnu[1]), mix(a.eyeEnu[2], b.eyeEnu[2])],
    rotation: slerp(a.rotation, b.rotation, u),
    fovyDeg: mix(a.fovyDeg, b.fovyDeg),
    orthoHeightM: both ? Math.exp(mix(Math.log(a.orthoHeightM ?? 1), Math.log(b.orthoHeightM ?? 1))) : nearest,
  };
}

/** The view turned about the place in its middle so that north is up; null: the camera turns on the spot. */
export function northUp(pose: Pose, targetEnu: Vec3 | null): Pose {
  const { yawDeg, pitchDeg } = anglesOfPose(pose.rotation);
  const rotation = rotationFromAngles({ yawDeg: 0, pitchDeg, rollDeg: 0 });
  if (targetEnu === null) return { ...pose, rotation };
  const yaw = (yawDeg * Math.PI) / 180;
  const east = pose.eyeEnu[0] - targetEnu[0];
  const north = pose.eyeEnu[1] - targetEnu[1];
  // Yaw grows clockwise, so taking it back turns the eye counter-clockwise.
  const eyeEnu: Vec3 = [
    targetEnu[0] + Math.cos(yaw) * east - Math.sin(yaw) * north,
    targetEnu[1] + Math.sin(yaw) * east + Math.cos(yaw) * north,
    pose.eyeEnu[2],
  ];
  return { ...pose, eyeEnu, rotation };
}
