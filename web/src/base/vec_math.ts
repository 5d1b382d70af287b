// Arithmetic of Vec3 and Quat (w, x, y, z). A quaternion b_from_a rotates a vector in a into b; quatMultiply(c_from_b, b_from_a) is c_from_a.
import type { Quat, Vec3 } from "./vec.js";

export function add(a: Vec3, b: Vec3): Vec3 {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

export function sub(a: Vec3, b: Vec3): Vec3 {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

export function scale(a: Vec3, factor: number): Vec3 {
  return [a[0] * factor, a[1] * factor, a[2] * factor];
}

export function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a: Vec3, b: Vec3): Vec3 {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function norm(a: Vec3): number {
  return Math.hypot(a[0], a[1], a[2]);
}

/** Zero stays zero. */
export function normalize(a: Vec3): Vec3 {
  const length = norm(a);
  return length > 0 ? scale(a, 1 / length) : [0, 0, 0];
}

/** First b, then a. */
export function quatMultiply(a: Quat, b: Quat): Quat {
  return [
    a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
    a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
    a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
    a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
  ];
}

/** The inverse, for length 1. */
export function quatConjugate(q: Quat): Quat {
  return [q[0], -q[1], -q[2], -q[3]];
}

/** Length 1; no rotation when all are 0. */
export function quatNormalize(q: Quat): Quat {
  const length = Math.hypot(q[0], q[1], q[2], q[3]);
  return length > 0 ? [q[0] / length, q[1] / length, q[2] / length, q[3] / length] : [1, 0, 0, 0];
}

export function quatRotate(q: Quat, v: Vec3): Vec3 {
  const axis: Vec3 = [q[1], q[2], q[3]];
  const t = scale(cross(axis, v), 2);
  return add(add(v, scale(t, q[0])), cross(axis, t));
}

/** Of a rotation matrix, 9 numbers row by row. The largest component is computed first, which keeps all digits. w >= 0. */
export function quatFromMatrix(m: readonly number[]): Quat {
  const [xx = 1, xy = 0, xz = 0, yx = 0, yy = 1, yz = 0, zx = 0, zy = 0, zz = 1] = m;
  const trace = xx + yy + zz;
  let q: Quat;
  if (trace > 0) {
    q = [1 + trace, zy - yz, xz - zx, yx - xy];
  } else if (xx >= yy && xx >= zz) {
    q = [zy - yz, 1 + xx - yy - zz, xy + yx, xz + zx];
  } else if (yy >= zz) {
    q = [xz - zx, xy + yx, 1 - xx + yy - zz, yz + zy];
  } else {
    q = [yx - xy, xz + zx, yz + zy, 1 - xx - yy + zz];
  }
  const unit = quatNormalize(q);
  return unit[0] < 0 ? [-unit[0], -unit[1], -unit[2], -unit[3]] : unit;
}

/** 9 numbers, row by row. */
export function matrixFromQuat(q: Quat): number[] {
  const [w, x, y, z] = q;
  return [
    1 - 2 * (y * y + z * z),
    2 * (x * y - w * z),
    2 * (x * z + w * y),
    2 * (x * y + w * z),
    1 - 2 * (x * x + z * z),
    2 * (y * z - w * x),
    2 * (x * z - w * y),
    2 * (y * z + w * x),
    1 - 2 * (x * x + y * y),
  ];
}

/** From a (u = 0) to b (u = 1) the shorter way at constant speed. */
export function slerp(a: Quat, b: Quat, u: number): Quat {
  let cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const sign = cosine < 0 ? -1 : 1;
  cosine = Math.abs(cosine);
  let from = 1 - u;
  let to = u;
  // Below this angle the sines cancel, and the chord is as good as the arc.
  if (cosine < 1 - 1e-9) {
    const angle = Math.acos(cosine);
    from = Math.sin((1 - u) * angle) / Math.sin(angle);
    to = Math.sin(u * angle) / Math.sin(angle);
  }
  to *= sign;
  return quatNormalize([
    from * a[0] + to * b[0],
    from * a[1] + to * b[1],
    from * a[2] + to * b[2],
    from * a[3] + to * b[3],
  ]);
}

/** Angle between two rotations, 0 to pi. */
export function angleBetweenRad(a: Quat, b: Quat): number {
  const d = quatMultiply(quatConjugate(a), b);
  return 2 * Math.atan2(Math.hypot(d[1], d[2], d[3]), Math.abs(d[0]));
}

/** A homogeneous matrix, 16 numbers row by row, times a point. */
export function transformPoint(matrix: readonly number[], p: Vec3): Vec3 {
  const row = (i: number) =>
    (matrix[4 * i] ?? 0) * p[0] +
    (matrix[4 * i + 1] ?? 0) * p[1] +
    (matrix[4 * i + 2] ?? 0) * p[2] +
    (matrix[4 * i + 3] ?? 0);
  return [row(0), row(1), row(2)];
}
