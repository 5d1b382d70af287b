// Turns a view so that north is up, about the place that it looks at.
import type { Vec3 } from "../../base/vec.js";
import { anglesOfPose, rotationFromAngles } from "../../geo/camera.js";
import type { CameraPose } from "../../state/app_state.js";
import type { AppContext } from "../context.js";

/** `targetEnu`: what is in the middle of the view; null: the camera turns on the spot. */
export function northUp(pose: CameraPose, targetEnu: Vec3 | null): CameraPose {
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

export function turnNorthUp({ scene }: Pick<AppContext, "scene">): Promise<void> {
  const { clientWidth: w, clientHeight: h } = scene.canvas;
  return scene.flyTo(northUp(scene.pose(), scene.pickSurface([w / 2, h / 2])?.enu ?? null));
}
