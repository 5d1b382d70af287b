// The clip box's numbers: each face stays on its side of the opposite one.
import type { Vec3 } from "../base/vec.js";
import type { ClipBox } from "./app_state.js";

export type Axis = 0 | 1 | 2;
export type Side = "min" | "max";

/** A box thinner than this shows nothing that could be recognised. */
const THINNEST_M = 0.1;

export function withFace(box: ClipBox, side: Side, axis: Axis, valueM: number): ClipBox {
  if (!Number.isFinite(valueM)) return box;
  const other = side === "min" ? box.max[axis] : box.min[axis];
  const value = side === "min" ? Math.min(valueM, other - THINNEST_M) : Math.max(valueM, other + THINNEST_M);
  return side === "min"
    ? { ...box, min: replaceAt(box.min, axis, value) }
    : { ...box, max: replaceAt(box.max, axis, value) };
}

function replaceAt(v: Vec3, axis: Axis, value: number): Vec3 {
  return [axis === 0 ? value : v[0], axis === 1 ? value : v[1], axis === 2 ? value : v[2]];
}

/** The box around these points and a margin; null without points. */
export function boxAround(points: readonly Vec3[], marginM: number): { readonly min: Vec3; readonly max: Vec3 } | null {
  const finite = points.filter((point) => point.every(Number.isFinite));
  if (finite.length === 0) return null;
  const least = (axis: Axis): number => Math.min(...finite.map((point) => point[axis])) - marginM;
  const most = (axis: Axis): number => Math.max(...finite.map((point) => point[axis])) + marginM;
  return { min: [least(0), least(1), least(2)], max: [most(0), most(1), most(2)] };
}
