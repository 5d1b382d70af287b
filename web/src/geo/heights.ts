// Heights in the survey's system from z of ENU. The Earth curves away below the flat ENU frame, so the two differ by more than a constant: 0.7 m at
// 3 km from the origin. Differences of heights need the offset at each place.
import type { Vec2, Vec3 } from "../base/vec.js";
import { geodeticFromEnu, type HasOrigin } from "./earth.js";
import { middleInPlan } from "./measure.js";

export interface HeightProject extends HasOrigin {
  readonly georeferenced: boolean;
}

/** Height in the survey's system minus z of ENU at this place; 0 without geo-reference. */
export function heightOffsetM(project: HeightProject, at: Vec2, z: number): number {
  if (!project.georeferenced) return 0;
  const offset = geodeticFromEnu(project, [at[0], at[1], z]).heightM - z;
  return Number.isFinite(offset) ? offset : 0;
}

/** Offset at the middle of these corners. */
export function outlineOffsetM(project: HeightProject, points: readonly { readonly enu: Vec3 }[]): number {
  const z = points.reduce((sum, point) => sum + point.enu[2], 0) / Math.max(1, points.length);
  return heightOffsetM(project, middleInPlan(points.map((point) => point.enu)), z);
}

/** Offset at the middle of the project, on the ground. */
export function projectOffsetM(
  project: HeightProject & { readonly min: Vec3; readonly max: Vec3; readonly groundM: number },
): number {
  const { min, max, groundM } = project;
  return heightOffsetM(project, [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2], groundM);
}

/** z of ENU at these corners of the level whose height `z` has at the middle of the project. */
export function levelAtOutlineM(
  project: Parameters<typeof projectOffsetM>[0],
  points: readonly { readonly enu: Vec3 }[],
  z: number,
): number {
  return z + projectOffsetM(project) - outlineOffsetM(project, points);
}
