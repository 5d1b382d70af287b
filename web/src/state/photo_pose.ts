// The pose of a photo as a camera of the 3-D view, which knows neither distortion nor a shifted principal point.
import type { CameraPose } from "./app_state.js";
import type { Photo, PhotoCamera, ProjectBase } from "./project.js";

/** COLMAP's models with one focal length; the others begin with fx, fy. */
const ONE_FOCAL_LENGTH = new Set([
  "SIMPLE_PINHOLE",
  "SIMPLE_RADIAL",
  "RADIAL",
  "SIMPLE_RADIAL_FISHEYE",
  "RADIAL_FISHEYE",
]);
const SMALLEST_FOVY_DEG = 1;
const LARGEST_FOVY_DEG = 120;
const FALLBACK_FOVY_DEG = 50;

/** Distance of the upper edge from the middle on the plane at distance 1, of a lens that is no fisheye. */
function edgeTangent(camera: PhotoCamera, focalPx: number): number {
  const distorted = camera.height / (2 * focalPx);
  const omega = Math.abs(camera.model === "FOV" ? (camera.params[4] ?? 0) : 0);
  if (!(omega > 1e-6 && omega < Math.PI)) return distorted;
  return Math.tan(Math.min(distorted * omega, 1.5)) / (2 * Math.tan(omega / 2));
}

export function photoFovyDeg(camera: PhotoCamera): number {
  const focalPx = (ONE_FOCAL_LENGTH.has(camera.model) ? camera.params[0] : camera.params[1]) ?? Number.NaN;
  if (!(focalPx > 0) || !(camera.height > 0)) return FALLBACK_FOVY_DEG;
  // A fisheye's angle grows with the radius itself, that of other lenses with its arctangent.
  const rad = camera.model.includes("FISHEYE") ? camera.height / focalPx : 2 * Math.atan(edgeTangent(camera, focalPx));
  return Math.min(LARGEST_FOVY_DEG, Math.max(SMALLEST_FOVY_DEG, (rad * 180) / Math.PI));
}

export function photoPose(project: ProjectBase, photo: Photo): CameraPose {
  const camera = project.cameras[photo.camera];
  return {
    eyeEnu: photo.position,
    rotation: photo.rotation,
    fovyDeg: camera === undefined ? FALLBACK_FOVY_DEG : photoFovyDeg(camera),
    orthoHeightM: null,
  };
}
