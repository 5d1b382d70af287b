// Covariance of a point that a person picked, square metres, as the six numbers of a symmetric matrix.
import type { Vec3 } from "../base/vec.js";
import { dot, normalize } from "../base/vec_math.js";

/** What measuring needs of a picked point (state/app_state.ts, SurfacePoint). */
export interface MeasuredPoint {
  readonly enu: Vec3;
  /** Direction of the ray that found it. */
  readonly direction: Vec3;
  /** One standard deviation along the ray, metres; null: unknown. */
  readonly spreadM: number | null;
  /** Size of a pixel there, metres. */
  readonly pixelM: number;
}

/** xx, xy, xz, yy, yz, zz. */
export type Covariance = readonly [number, number, number, number, number, number];

/**
 * spread^2 d d^T + (pixel / 2)^2 (1 - d d^T): along the ray what the field says, across it half a pixel, because nobody clicks better than that.
 * Null when the spread is unknown, which is so for points of the mesh.
 */
export function pointCovariance(point: MeasuredPoint): Covariance | null {
  const { spreadM, pixelM } = point;
  const d = normalize(point.direction);
  if (spreadM === null || !(spreadM >= 0) || !(pixelM >= 0) || !Number.isFinite(spreadM + pixelM)) return null;
  if (!(dot(d, d) > 0.5)) return null;
  const across = (pixelM / 2) ** 2;
  const more = spreadM ** 2 - across;
  return [
    across + more * d[0] * d[0],
    more * d[0] * d[1],
    more * d[0] * d[2],
    across + more * d[1] * d[1],
    more * d[1] * d[2],
    across + more * d[2] * d[2],
  ];
}

/** Variance of g . x. */
export function varianceAlong(c: Covariance, g: Vec3): number {
  const [xx, xy, xz, yy, yz, zz] = c;
  const value =
    xx * g[0] * g[0] +
    yy * g[1] * g[1] +
    zz * g[2] * g[2] +
    2 * (xy * g[0] * g[1] + xz * g[0] * g[2] + yz * g[1] * g[2]);
  // Rounding may leave a tiny negative number; NaN stays NaN.
  return Math.max(0, value);
}

/** Mean square of the deviation in space. */
export function trace(c: Covariance): number {
  return c[0] + c[3] + c[5];
}

/** Mean square of the deviation in plan. */
export function planTrace(c: Covariance): number {
  return c[0] + c[3];
}

/** Mean square of x cross q, which is tr(C) |q|^2 - q^T C q. */
export function crossVariance(c: Covariance, q: Vec3): number {
  return Math.max(0, trace(c) * dot(q, q) - varianceAlong(c, q));
}
