// A project, points and random numbers for tests.
import type { Vec3 } from "../../../src/base/vec.js";
import { normalize } from "../../../src/base/vec_math.js";
import type { SurfacePoint } from "../../../src/state/app_state.js";
import type { Accuracy, Project } from "../../../src/state/project.js";

export const NO_ACCURACY: Accuracy = {
  scalePercent: null,
  tiltDeg: null,
  yawDeg: null,
  horizontalM: null,
  verticalM: null,
};

export function sampleProject(change: Partial<Project> = {}): Project {
  return {
    name: "town",
    revision: 1,
    georeferenced: true,
    origin: { latitudeDeg: 47.3769, longitudeDeg: 8.5417, heightM: 408.25 },
    crs: { name: "EPSG:32632", zone: 32, north: true },
    vertical: "heights above the WGS84 ellipsoid",
    accuracy: { scalePercent: 0.1, tiltDeg: 0.05, yawDeg: 0.05, horizontalM: 1.2, verticalM: 2 },
    min: [-100, -80, -5],
    max: [120, 90, 40],
    groundM: 2,
    gsdM: 0.03,
    scene: { blocks: 1, parameters: 1000, trust: true },
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
    before: null,
    ...change,
  };
}

export function samplePoint(enu: Vec3, spreadM: number | null = 0.05, direction: Vec3 = [0, 0, -1]): SurfacePoint {
  return { enu, direction: normalize(direction), spreadM, pixelM: 0.02, source: spreadM === null ? "mesh" : "field" };
}

/** Uniform in [0, 1), always the same numbers (Mulberry32). */
export function seededRandom(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = state;
    t = Math.imul(t ^ (t >>> 15), t | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** Normally distributed with deviation 1 (Box and Muller). */
export function seededNormal(seed: number): () => number {
  const random = seededRandom(seed);
  return () => Math.sqrt(-2 * Math.log(1 - random())) * Math.cos(2 * Math.PI * random());
}
