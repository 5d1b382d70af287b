// The clip box and the swipe as numbers: planes whose positive side is kept, and the parts of the canvas.
import type { Vec3 } from "../base/vec.js";
import type { ClipBox } from "../state/app_state.js";
import { type Box, sceneFromEnu, type World } from "./world.js";

/** A point p is kept when normal . p + constant >= 0. */
export interface HalfSpace {
  readonly normal: Vec3;
  readonly constant: number;
}

/** The box in scene coordinates, its corners in order; null: nothing is clipped. */
export function clipInScene(world: World, clip: ClipBox): Box | null {
  if (!clip.on) return null;
  const a = sceneFromEnu(world, clip.min);
  const b = sceneFromEnu(world, clip.max);
  if (![...a, ...b].every(Number.isFinite)) return null;
  const min: Vec3 = [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.min(a[2], b[2])];
  const max: Vec3 = [Math.max(a[0], b[0]), Math.max(a[1], b[1]), Math.max(a[2], b[2])];
  return { min, max };
}

/** Six half spaces whose common part is the box. */
export function halfSpacesOf(box: Box): HalfSpace[] {
  return [
    { normal: [1, 0, 0], constant: -box.min[0] },
    { normal: [-1, 0, 0], constant: box.max[0] },
    { normal: [0, 1, 0], constant: -box.min[1] },
    { normal: [0, -1, 0], constant: box.max[1] },
    { normal: [0, 0, 1], constant: -box.min[2] },
    { normal: [0, 0, -1], constant: box.max[2] },
  ];
}

export function boxHolds(box: Box, p: Vec3): boolean {
  return (
    p[0] >= box.min[0] &&
    p[0] <= box.max[0] &&
    p[1] >= box.min[1] &&
    p[1] <= box.max[1] &&
    p[2] >= box.min[2] &&
    p[2] <= box.max[2]
  );
}

/** Columns of the canvas for each side; `at` 0 to 1 of its width. Together they are the whole width, without overlap. */
export function swipeColumns(
  at: number,
  width: number,
): {
  readonly before: { readonly x: number; readonly w: number };
  readonly main: { readonly x: number; readonly w: number };
} {
  const line = Math.round(Math.min(1, Math.max(0, Number.isFinite(at) ? at : 0.5)) * width);
  return { before: { x: 0, w: line }, main: { x: line, w: width - line } };
}
