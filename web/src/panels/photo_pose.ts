// The pose of a photo as a camera of the 3-D view, which knows neither distortion nor a shifted principal point.
import type { CameraPose } from "../state/app_state.js";
import type { Photo, PhotoCamera, ProjectBase } from "../state/project.js";

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

export function photoFovyDeg(camera: PhotoCamera): number {
  const focalPx = (ONE_FOCAL_LENGTH.has(camera.model) ? camera.params[0] : camera.params[1]) ?? Number.NaN;
  if (!(focalPx > 0) || !(camera.height > 0)) return FALLBACK_FOVY_DEG;
  // A fisheye's angle grows with the radius itself, that of other lenses with its arctangent.
  const rad = camera.model.includes("FISHEYE") ? camera.height / focalPx : 2 * Math.atan(camera.height / (2 * focalPx));
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
