// The view as a stop's pose.
import { FOVY_DEG } from "../tour/limits.js";
import type { TourPose } from "../tour/types.js";
import { keyPose, type PoseSource } from "./camera_path.js";

export function tourPose(scene: PoseSource): TourPose {
  const { eyeEnu, rotation, fovyDeg } = keyPose(scene);
  return { eyeEnu, rotation, fovyDeg: Math.min(FOVY_DEG.most, Math.max(FOVY_DEG.least, fovyDeg)) };
}
