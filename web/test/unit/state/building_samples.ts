// Buildings for tests: a box with a flat roof, as buildings.json has it and as it is read.
import type { Vec3 } from "../../../src/base/vec.js";
import { type Building, type BuildingSet, MEASURE_NAMES, type Solid } from "../../../src/state/buildings.js";

/** Corners of a box, numbered by 4 x + 2 y + z of 0 (min) or 1 (max); faces counter-clockwise from outside. */
export function boxSolid(min: Vec3, max: Vec3): Solid {
  const vertices = [0, 1, 2, 3, 4, 5, 6, 7].map(
    (i): Vec3 => [i & 4 ? max[0] : min[0], i & 2 ? max[1] : min[1], i & 1 ? max[2] : min[2]],
  );
  const wall = (ring: number[]) => ({ kind: "wall", rings: [ring] }) as const;
  return {
    vertices,
    faces: [
      { kind: "ground", rings: [[0, 2, 6, 4]] },
      { kind: "roof", rings: [[1, 5, 7, 3]] },
      wall([0, 4, 5, 1]),
      wall([4, 6, 7, 5]),
      wall([6, 2, 3, 7]),
      wall([2, 0, 1, 3]),
    ],
  };
}

export function sampleBuilding(id: number, change: Partial<Building> = {}): Building {
  const unknown = Object.fromEntries(MEASURE_NAMES.map((name) => [name, null])) as Building["measures"];
  return {
    id,
    roof: "flat",
    accepted: true,
    note: "",
    givenId: "",
    measures: unknown,
    wallSeen: 0.5,
    shareWithin: 0.9,
    roofPoints: 1200,
    solid: boxSolid([0, 0, 0], [10, 6, 4]),
    ...change,
  };
}

export function sampleSet(buildings: readonly Building[], change: Partial<BuildingSet> = {}): BuildingSet {
  return { metric: true, scaleSource: "geo-reference", buildings, ...change };
}
