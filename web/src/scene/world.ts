// The frame that the scene is drawn in: ENU of the main project minus an anchor near its middle, so that single precision on the graphics card is
// enough. Axes are those of ENU, z up. Everything here is in doubles; matrices are homogeneous, 16 numbers row by row.
import type { Vec3 } from "../base/vec.js";
import { norm, sub } from "../base/vec_math.js";
import { enuFromEcefMatrix } from "../geo/earth.js";
import type { ProjectBase } from "../state/project.js";

export interface Box {
  readonly min: Vec3;
  readonly max: Vec3;
}

export interface World {
  readonly anchor: Vec3;
  /** What is worth looking at, in ENU: the project's box. Never empty. */
  readonly boxEnu: Box;
  /** Typical height of the ground, z of ENU. */
  readonly groundM: number;
  /** Diagonal of the box, metres. */
  readonly sizeM: number;
}

const LEAST_SIZE_M = 1;

function finiteOr(value: number, otherwise: number): number {
  return Number.isFinite(value) ? value : otherwise;
}

export function makeWorld(project: ProjectBase): World {
  const axis = (i: 0 | 1 | 2): readonly [number, number] => {
    const low = finiteOr(project.min[i], -50);
    const high = finiteOr(project.max[i], low + 100);
    const middle = (low + high) / 2;
    const half = Math.max(Math.abs(high - low), LEAST_SIZE_M) / 2;
    return [middle - half, middle + half];
  };
  const [x, y, z] = [axis(0), axis(1), axis(2)];
  const boxEnu: Box = { min: [x[0], y[0], z[0]], max: [x[1], y[1], z[1]] };
  const groundM = Math.min(z[1], Math.max(z[0], finiteOr(project.groundM, z[0])));
  // Whole metres: the subtraction then loses no digit.
  const anchor: Vec3 = [Math.round((x[0] + x[1]) / 2), Math.round((y[0] + y[1]) / 2), Math.round(groundM)];
  return { anchor, boxEnu, groundM, sizeM: norm(sub(boxEnu.max, boxEnu.min)) };
}

export function sceneFromEnu(world: World, enu: Vec3): Vec3 {
  return sub(enu, world.anchor);
}

export const IDENTITY: readonly number[] = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export function translation(by: Vec3): number[] {
  return [1, 0, 0, by[0], 0, 1, 0, by[1], 0, 0, 1, by[2], 0, 0, 0, 1];
}

/** a times b. */
export function multiply(a: readonly number[], b: readonly number[]): number[] {
  const product = new Array<number>(16).fill(0);
  for (let row = 0; row < 4; row += 1) {
    for (let column = 0; column < 4; column += 1) {
      let sum = 0;
      for (let k = 0; k < 4; k += 1) sum += (a[4 * row + k] ?? 0) * (b[4 * k + column] ?? 0);
      product[4 * row + column] = sum;
    }
  }
  return product;
}

/** From a project's own ENU frame into the scene. `enuFromOwn`: its ENU into that of the main project. */
export function sceneFromOwnEnu(world: World, enuFromOwn: readonly number[] = IDENTITY): number[] {
  return multiply(translation([-world.anchor[0], -world.anchor[1], -world.anchor[2]]), enuFromOwn);
}

/**
 * From the frame of a project's tileset into the scene. With a geo-reference the tileset's root transform leads to ECEF, without one its tiles are in
 * the local frame (surface/files/tileset_writer.cpp).
 */
export function sceneFromTiles(world: World, project: ProjectBase, enuFromOwn: readonly number[] = IDENTITY): number[] {
  const fromEnu = sceneFromOwnEnu(world, enuFromOwn);
  return project.georeferenced ? multiply(fromEnu, enuFromEcefMatrix(project.origin)) : fromEnu;
}
