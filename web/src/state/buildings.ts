// The buildings that `skyquilt buildings` has found, as protocol/buildings_reader.ts has read them. Places are ENU of the survey; measures have the
// scale that the program knows, in metres when `metric`.
import type { Vec3 } from "../base/vec.js";
import { type HeightProject, heightOffsetM } from "../geo/heights.js";
import type { Estimate } from "../geo/measure.js";

export const ROOF_KINDS = ["flat", "gable", "hip", "other"] as const;
export type RoofKind = (typeof ROOF_KINDS)[number];
export const FACE_KINDS = ["ground", "wall", "roof"] as const;
export type FaceKind = (typeof FACE_KINDS)[number];

/** Names without unit; ground, eave and ridge are heights. */
export const MEASURE_NAMES = [
  "ground",
  "eave",
  "ridge",
  "height",
  "length",
  "width",
  "yaw",
  "area",
  "roofArea",
  "volume",
  "pitch",
] as const;
export type MeasureName = (typeof MEASURE_NAMES)[number];

export interface Face {
  readonly kind: FaceKind;
  /** Numbers of vertices: the outline, counter-clockwise from outside, then holes. */
  readonly rings: readonly (readonly number[])[];
}
export interface Solid {
  readonly vertices: readonly Vec3[];
  readonly faces: readonly Face[];
}

export interface Building {
  readonly id: number;
  readonly roof: RoofKind;
  /** The model describes the points of the roof. */
  readonly accepted: boolean;
  readonly note: string;
  /** Its name in the file of outlines that the person gave; may be empty. */
  readonly givenId: string;
  /** Null: not known. Heights are z of ENU. */
  readonly measures: Readonly<Record<MeasureName, Estimate | null>>;
  /** 0 to 1: share of the walls that photos show. */
  readonly wallSeen: number | null;
  /** 0 to 1: share of the roof's points that are close to the model. */
  readonly shareWithin: number | null;
  readonly roofPoints: number;
  readonly solid: Solid;
}

export interface BuildingSet {
  /** Lengths are metres; otherwise their unit is unknown and none is shown. */
  readonly metric: boolean;
  readonly scaleSource: string;
  readonly buildings: readonly Building[];
}

export interface BuildingsState {
  readonly set: BuildingSet | null;
  readonly loading: boolean;
  /** Why they could not be read; empty: they could, or were not asked for yet. */
  readonly error: string;
}
export const NO_BUILDINGS: BuildingsState = { set: null, loading: false, error: "" };

export interface BuildingBox {
  readonly min: Vec3;
  readonly max: Vec3;
}

/** Around the model. */
export function boxOfBuilding({ solid }: Building): BuildingBox {
  const along = (axis: 0 | 1 | 2, pick: (...values: number[]) => number): number =>
    solid.vertices.reduce((value, vertex) => pick(value, vertex[axis]), solid.vertices[0]?.[axis] ?? 0);
  return {
    min: [along(0, Math.min), along(1, Math.min), along(2, Math.min)],
    max: [along(0, Math.max), along(1, Math.max), along(2, Math.max)],
  };
}

/** Above its middle, as high as its roof. */
export function topOfBuilding(building: Building): Vec3 {
  const { min, max } = boxOfBuilding(building);
  return [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, max[2]];
}

export function findBuilding(set: BuildingSet | null, id: number | null): Building | null {
  if (set === null || id === null) return null;
  return set.buildings.find((building) => building.id === id) ?? null;
}

/** As the maps and buildings.csv have it: the ground gets the height of the geo-reference there, eave and ridge stand above it as measured. */
export function measureOf(building: Building, name: MeasureName, project: HeightProject): Estimate | null {
  const measure = building.measures[name];
  if (measure === null || (name !== "ground" && name !== "eave" && name !== "ridge")) return measure;
  const [x, y, top] = topOfBuilding(building);
  const z = building.measures.ground?.value ?? top;
  return { value: measure.value + heightOffsetM(project, [x, y], z), sigma: measure.sigma };
}
