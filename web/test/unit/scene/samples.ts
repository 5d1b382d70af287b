// A small project for the tests of this folder.
import type { Vec3 } from "../../../src/base/vec.js";
import { poseLookingAt } from "../../../src/geo/camera.js";
import type { CameraPose } from "../../../src/state/app_state.js";
import type { Project, ProjectBase } from "../../../src/state/project.js";

export function sampleBase(patch: Partial<ProjectBase> = {}): ProjectBase {
  return {
    name: "town",
    revision: 1,
    georeferenced: true,
    origin: { latitudeDeg: 47.3769, longitudeDeg: 8.5417, heightM: 408 },
    crs: { name: "EPSG:32632", zone: 32, north: true },
    vertical: "WGS84 ellipsoid",
    accuracy: { scalePercent: null, tiltDeg: null, yawDeg: null, horizontalM: null, verticalM: null },
    min: [-157.4, -135.7, -2.6],
    max: [161.4, 134.3, 30.7],
    groundM: 0.5,
    gsdM: 0.18,
    scene: { blocks: 4, parameters: 1000, trust: true },
    tiles: "/data/tiles/tileset.json",
    terrain: null,
    orthophoto: null,
    points: null,
    contours: null,
    surface: null,
    buildings: null,
    blocks: [],
    cameras: [],
    photos: [],
    metrics: null,
    missing: [],
    ...patch,
  };
}

export function sampleProject(patch: Partial<Project> = {}): Project {
  return { ...sampleBase(), before: null, ...patch };
}

export function lookingAt(eyeEnu: Vec3, target: Vec3, orthoHeightM: number | null = null): CameraPose {
  return { eyeEnu, rotation: poseLookingAt(eyeEnu, target), fovyDeg: 50, orthoHeightM };
}
