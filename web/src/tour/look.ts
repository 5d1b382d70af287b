// Looking around from where one is.
import { anglesOfPose, type Pose, rotationFromAngles } from "../geo/camera.js";

const LOWEST_DEG = -90;
const HIGHEST_DEG = 89;

/** To the right and up by these angles, the horizon level. Pitch ends straight below and almost straight above. */
export function lookedAround(pose: Pose, dYawDeg: number, dPitchDeg: number): Pose {
  if (!Number.isFinite(dYawDeg) || !Number.isFinite(dPitchDeg)) return pose;
  const { yawDeg, pitchDeg } = anglesOfPose(pose.rotation);
  const within = Math.min(HIGHEST_DEG, Math.max(LOWEST_DEG, pitchDeg + dPitchDeg));
  return { ...pose, rotation: rotationFromAngles({ yawDeg: yawDeg + dYawDeg, pitchDeg: within, rollDeg: 0 }) };
}
