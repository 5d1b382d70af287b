// Poses that show a box or a place: the first view, the view from above, and the way between perspective and orthographic.
import type { Quat, Vec3 } from "../base/vec.js";
import { add, dot, scale, sub } from "../base/vec_math.js";
import { anglesOfPose, forward, right, rotationFromAngles, up } from "../geo/camera.js";
import type { CameraPose } from "../state/app_state.js";
import { cornersOf, halfHeight, type Size } from "./view_math.js";
import type { Box, World } from "./world.js";

export const DEFAULT_FOVY_DEG = 50;
const FIRST_PITCH_DEG = -45;
const MARGIN = 1.05;

function middleOf(box: Box): Vec3 {
  return scale(add(box.min, box.max), 0.5);
}

/** Height from which orthographic views look down: above all there is. */
export function aboveAll(world: World): number {
  return world.boxEnu.max[2] + 0.05 * world.sizeM + 10;
}

/** From the south, 45 degrees down, so that the box fills the picture. */
export function obliquePose(box: Box, size: Size, yawDeg = 0): CameraPose {
  const rotation = rotationFromAngles({ yawDeg, pitchDeg: FIRST_PITCH_DEG, rollDeg: 0 });
  const [ahead, aside, above] = [forward(rotation), right(rotation), up(rotation)];
  const tanY = Math.tan((DEFAULT_FOVY_DEG * Math.PI) / 360);
  const tanX = (tanY * Math.max(1, size[0])) / Math.max(1, size[1]);
  const middle = middleOf(box);
  const corners = cornersOf(box).map((corner) => {
    const d = sub(corner, middle);
    return { x: dot(aside, d), y: dot(above, d), z: dot(ahead, d) };
  });
  // Far parts look smaller, so the box is not in the middle of the picture when the camera looks at its middle: the axis is shifted up or down. How
  // far depends on the distance and the other way round; a few rounds settle it.
  let shift = 0;
  let distance = 1;
  for (let round = 0; round < 8; round += 1) {
    distance = 1;
    for (const { x, y, z } of corners) {
      distance = Math.max(
        distance,
        (Math.abs(x) * MARGIN) / tanX - z,
        (Math.abs(y - shift) * MARGIN) / tanY - z,
        0.1 - z,
      );
    }
    const slopes = corners.map(({ y, z }) => (y - shift) / (distance + z));
    shift += ((Math.max(...slopes) + Math.min(...slopes)) / 2) * distance;
  }
  for (const { x, y, z } of corners) {
    distance = Math.max(distance, (Math.abs(x) * MARGIN) / tanX - z, (Math.abs(y - shift) * MARGIN) / tanY - z);
  }
  const eyeEnu = add(middle, sub(scale(above, shift), scale(ahead, distance)));
  return { eyeEnu, rotation, fovyDeg: DEFAULT_FOVY_DEG, orthoHeightM: null };
}

function downRotation(yawDeg: number): Quat {
  return rotationFromAngles({ yawDeg, pitchDeg: -90, rollDeg: 0 });
}

/** The box from straight above, orthographic, north up. */
export function topPose(box: Box, size: Size, world: World): CameraPose {
  const middle = middleOf(box);
  const aspect = Math.max(1, size[0]) / Math.max(1, size[1]);
  const height = Math.max(1, MARGIN * Math.max(box.max[1] - box.min[1], (box.max[0] - box.min[0]) / aspect));
  return {
    eyeEnu: [middle[0], middle[1], aboveAll(world)],
    rotation: downRotation(0),
    fovyDeg: DEFAULT_FOVY_DEG,
    orthoHeightM: height,
  };
}

/** The view from above at about the scale that a perspective has at `focus`. */
export function topFrom(pose: CameraPose, focus: Vec3, world: World, yawDeg = 0): CameraPose {
  const distance = Math.max(1, dot(forward(pose.rotation), sub(focus, pose.eyeEnu)));
  const height = Math.min(3 * world.sizeM, Math.max(1, 2 * distance * halfHeight(pose)));
  return {
    ...pose,
    eyeEnu: [focus[0], focus[1], aboveAll(world)],
    rotation: downRotation(yawDeg),
    orthoHeightM: height,
  };
}

/** The perspective that shows the ground like this orthographic view; the same pose when it is a perspective already. */
export function perspectiveOf(pose: CameraPose, world: World): CameraPose {
  if (pose.orthoHeightM === null) return pose;
  const ahead = forward(pose.rotation);
  // Where the middle of the picture meets the ground; level views have no such place, there the eye's own is used.
  const along = ahead[2] < -0.03 ? (world.groundM - pose.eyeEnu[2]) / ahead[2] : world.sizeM;
  const distance = pose.orthoHeightM / (2 * halfHeight(pose));
  return { ...pose, eyeEnu: add(pose.eyeEnu, scale(ahead, along - distance)), orthoHeightM: null };
}

/** An oblique view of the same place, to leave the view from above. */
export function obliqueFromTop(pose: CameraPose, world: World): CameraPose {
  const above = perspectiveOf(pose, world);
  const distance = (pose.orthoHeightM ?? world.sizeM) / (2 * halfHeight(pose));
  const target = add(above.eyeEnu, scale(forward(above.rotation), distance));
  const rotation = rotationFromAngles({ yawDeg: anglesOfPose(pose.rotation).yawDeg, pitchDeg: -50, rollDeg: 0 });
  return { ...above, rotation, eyeEnu: sub(target, scale(forward(rotation), distance)) };
}
