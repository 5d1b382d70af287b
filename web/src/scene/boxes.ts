// Boxes in ENU of the main project that near and far of the camera must hold.
import type { Vec3 } from "../base/vec.js";
import { transformPoint } from "../base/vec_math.js";
import type { Project } from "../state/project.js";
import { cornersOf } from "./view_math.js";
import { type Box, makeWorld } from "./world.js";

/** The smallest box around these points and the box; points that are not finite do not count. */
export function boxWith(box: Box, points: readonly Vec3[]): Box {
  let { min, max } = box;
  for (const p of points) {
    if (!p.every(Number.isFinite)) continue;
    min = [Math.min(min[0], p[0]), Math.min(min[1], p[1]), Math.min(min[2], p[2])];
    max = [Math.max(max[0], p[0]), Math.max(max[1], p[1]), Math.max(max[2], p[2])];
  }
  return { min, max };
}

/** Corners of the earlier project's box; empty without one. */
export function cornersOfBefore({ before }: Project): readonly Vec3[] {
  if (before === null) return [];
  return cornersOf(makeWorld(before).boxEnu).map((corner) => transformPoint(before.enuFromBefore, corner));
}
