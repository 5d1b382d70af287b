// camera_path.json: what `skyquilt render --path` reads (products/camera_path_file.cpp). That reader refuses unknown keys in a view, but not beside
// "views": there the member "skyquilt" keeps what the format lacks (speed, free names, orthographic heights).
import {
  asArray,
  asInteger,
  asNumber,
  asObject,
  asString,
  asVec3,
  CheckError,
  type JsonObject,
  optional,
} from "../base/check.js";
import type { Vec3 } from "../base/vec.js";
import { anglesOfPose, rotationFromAngles } from "../geo/camera.js";
import { enuFromGeodetic } from "../geo/earth.js";
import type { CameraPath, KeyFrame } from "./app_state.js";
import {
  FASTEST_MPS,
  fovAcrossDeg,
  fovyOfAcrossDeg,
  framesBetween,
  MOST_FRAMES_BETWEEN,
  pathLengthM,
  SLOWEST_MPS,
  VIDEO_ASPECT,
  VIDEO_FPS,
} from "./camera_path.js";
import { NO_DOCUMENTS } from "./initial.js";
import { fileName, freeName } from "./names.js";
import type { ProjectBase } from "./project.js";

type PlacedProject = Pick<ProjectBase, "origin" | "georeferenced">;

const MOST_KEYS = 10_000;
const VIEW_KEYS = ["position_enu", "longitude", "latitude", "height", "yaw", "pitch", "roll", "fov", "name"];
const DEFAULT_FOV_DEG = 60;

/** Names of views become names of pictures: no path, not hidden, each once, and none that `render` gives to frames itself. */
function fileNames(keys: readonly KeyFrame[]): string[] {
  const taken = new Set<string>();
  return keys.map(({ name }) => {
    const plain = fileName(name);
    const base = plain === "" || /^view_\d+$/i.test(plain) ? `key ${plain}`.trim() : plain;
    let free = base;
    for (let number = 2; taken.has(free.toLowerCase()); number += 1) free = `${base} (${number})`;
    taken.add(free.toLowerCase());
    return free;
  });
}

/** Without the noise of the last bits, which would make a level camera one with a roll of -9e-15. */
function roundedDeg(deg: number): number {
  return Math.round(deg * 1e9) / 1e9;
}

export function writeCameraPath(path: CameraPath): string {
  const names = fileNames(path.keys);
  const views = path.keys.map(({ pose }, i) => {
    const { yawDeg, pitchDeg, rollDeg } = anglesOfPose(pose.rotation);
    const numbers = [...pose.eyeEnu, yawDeg, pitchDeg, rollDeg, pose.fovyDeg];
    if (!numbers.every(Number.isFinite)) throw new CheckError(`views[${i}]`, "it has a number that is not finite");
    return {
      name: names[i],
      position_enu: pose.eyeEnu,
      yaw: roundedDeg(yawDeg),
      pitch: roundedDeg(pitchDeg),
      roll: roundedDeg(rollDeg),
      fov: fovAcrossDeg(pose.fovyDeg, VIDEO_ASPECT),
    };
  });
  const document = {
    views,
    frames_between: framesBetween(path),
    skyquilt: {
      version: 1,
      speed_mps: path.speedMps,
      aspect: VIDEO_ASPECT,
      keys: path.keys.map(({ name, pose }) => ({ name, ortho_height_m: pose.orthoHeightM })),
    },
  };
  return `${JSON.stringify(document)}\n`;
}

/** Throws CheckError. Also takes files that people have written: a plain list, places by longitude and latitude. */
export function readCameraPath(value: unknown, project: PlacedProject): CameraPath {
  const root = Array.isArray(value) ? { views: value } : asObject(value, "");
  const list = asArray(root.views, "views", MOST_KEYS);
  const frames = optional(root.frames_between, "frames_between", (given, at) =>
    asInteger(given, at, 0, MOST_FRAMES_BETWEEN),
  );
  const extra = optional(root.skyquilt, "skyquilt", readExtra);
  const views = list.map((view, i) => readView(view, `views[${i}]`, project, extra?.aspect ?? VIDEO_ASPECT));
  const names = extra === null ? [] : fileNames(extra.keys);
  const keys: KeyFrame[] = [];
  views.forEach((view, i) => {
    // Somebody who edits the views by hand wins over what was kept beside them.
    const kept = names[i] === view.name ? extra?.keys[i] : undefined;
    const name =
      kept?.name ??
      view.name ??
      freeName(
        "Key",
        keys.map((key) => key.name),
      );
    keys.push({ name, pose: { ...view.pose, orthoHeightM: kept?.pose.orthoHeightM ?? null } });
  });
  return { keys, speedMps: extra?.speedMps ?? speedOf(keys, frames) };
}

function readExtra(value: unknown, path: string) {
  const extra = asObject(value, path);
  asInteger(extra.version, `${path}.version`, 1, 1);
  const keys = asArray(extra.keys, `${path}.keys`, MOST_KEYS).map((entry, i): KeyFrame => {
    const at = `${path}.keys[${i}]`;
    const key = asObject(entry, at);
    const height = optional(key.ortho_height_m, `${at}.ortho_height_m`, (given, place) => asNumber(given, place, 0));
    // The pose comes from the view.
    return {
      name: asString(key.name, `${at}.name`, 1000),
      pose: { eyeEnu: [0, 0, 0], rotation: [1, 0, 0, 0], fovyDeg: DEFAULT_FOV_DEG, orthoHeightM: height },
    };
  });
  return {
    keys,
    speedMps: asNumber(extra.speed_mps, `${path}.speed_mps`, SLOWEST_MPS, FASTEST_MPS),
    aspect: asNumber(extra.aspect, `${path}.aspect`, 0.01, 100),
  };
}

function readView(value: unknown, path: string, project: PlacedProject, aspect: number) {
  const view = asObject(value, path);
  const unknown = Object.keys(view).find((key) => !VIEW_KEYS.includes(key));
  if (unknown !== undefined) throw new CheckError(path, `unknown key "${unknown.slice(0, 40)}"`);
  const number = (key: string, otherwise: number) =>
    view[key] === undefined ? otherwise : asNumber(view[key], `${path}.${key}`);
  const fovDeg = view.fov === undefined ? DEFAULT_FOV_DEG : asNumber(view.fov, `${path}.fov`);
  if (!(fovDeg > 0 && fovDeg < 180)) throw new CheckError(`${path}.fov`, `${fovDeg} is not between 0 and 180 degrees`);
  const name = view.name === undefined ? null : asString(view.name, `${path}.name`, 1000);
  if (name === "") throw new CheckError(`${path}.name`, "it is empty");
  return {
    name,
    pose: {
      eyeEnu: readPlace(view, path, project),
      rotation: rotationFromAngles({
        yawDeg: number("yaw", 0),
        pitchDeg: number("pitch", 0),
        rollDeg: number("roll", 0),
      }),
      fovyDeg: fovyOfAcrossDeg(fovDeg, aspect),
      orthoHeightM: null,
    },
  };
}

function readPlace(view: JsonObject, path: string, project: PlacedProject): Vec3 {
  if (view.position_enu !== undefined) return asVec3(view.position_enu, `${path}.position_enu`);
  const place = {
    latitudeDeg: asNumber(view.latitude, `${path}.latitude`, -90, 90),
    longitudeDeg: asNumber(view.longitude, `${path}.longitude`, -360, 360),
    heightM: asNumber(view.height, `${path}.height`),
  };
  if (!project.georeferenced) {
    throw new CheckError(path, "it is given by longitude and latitude, but the project has no geo-reference");
  }
  return enuFromGeodetic(project, place);
}

/** The speed at which the video of a file without one passes. */
function speedOf(keys: readonly KeyFrame[], frames: number | null): number {
  const length = pathLengthM(keys);
  if (frames === null || frames === 0 || keys.length < 2 || !(length > 0)) return NO_DOCUMENTS.cameraPath.speedMps;
  const seconds = ((keys.length - 1) * (frames + 1)) / VIDEO_FPS;
  return Math.min(FASTEST_MPS, Math.max(SLOWEST_MPS, length / seconds));
}
