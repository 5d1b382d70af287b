// The first triangle that a ray meets, straight from the arrays of a mesh: about 10 ns a triangle, so that a click needs no search tree.
import type { Vec3 } from "../base/vec.js";

export interface Triangles {
  /** x, y, z per vertex. */
  readonly positions: Float32Array;
  /** Three per triangle; null: vertices in order. */
  readonly indices: Uint16Array | Uint32Array | null;
}

/** Front: only triangles that turn their front (counter-clockwise) to the ray, as they are the ones of surfaces that are drawn. */
export type Sides = "front" | "both";

/**
 * Distance to the nearest hit in units of `direction`, less than `limit`; infinity: none. `accept` may refuse a hit, and what is behind it is looked
 * for.
 */
export function nearestHit(
  mesh: Triangles,
  origin: Vec3,
  direction: Vec3,
  limit = Number.POSITIVE_INFINITY,
  accept: (t: number) => boolean = () => true,
  sides: Sides = "front",
): number {
  const { positions: p, indices } = mesh;
  const [ox, oy, oz] = origin;
  const [dx, dy, dz] = direction;
  const count = indices === null ? Math.floor(p.length / 9) : Math.floor(indices.length / 3);
  let nearest = limit;
  let found = false;
  for (let i = 0; i < count; i += 1) {
    const a = 3 * (indices === null ? 3 * i : (indices[3 * i] ?? 0));
    const b = 3 * (indices === null ? 3 * i + 1 : (indices[3 * i + 1] ?? 0));
    const c = 3 * (indices === null ? 3 * i + 2 : (indices[3 * i + 2] ?? 0));
    const ax = p[a] ?? 0;
    const ay = p[a + 1] ?? 0;
    const az = p[a + 2] ?? 0;
    const e1x = (p[b] ?? 0) - ax;
    const e1y = (p[b + 1] ?? 0) - ay;
    const e1z = (p[b + 2] ?? 0) - az;
    const e2x = (p[c] ?? 0) - ax;
    const e2y = (p[c + 1] ?? 0) - ay;
    const e2z = (p[c + 2] ?? 0) - az;
    // Moeller and Trumbore 1997.
    const px = dy * e2z - dz * e2y;
    const py = dz * e2x - dx * e2z;
    const pz = dx * e2y - dy * e2x;
    const signed = e1x * px + e1y * py + e1z * pz;
    const sign = signed < 0 && sides === "both" ? -1 : 1;
    const det = sign * signed;
    if (!(det > 0)) continue;
    const tx = sign * (ox - ax);
    const ty = sign * (oy - ay);
    const tz = sign * (oz - az);
    // A little outside counts, so that no ray slips through between two triangles.
    const slack = 1e-7 * det;
    const u = tx * px + ty * py + tz * pz;
    if (u < -slack || u > det + slack) continue;
    const qx = ty * e1z - tz * e1y;
    const qy = tz * e1x - tx * e1z;
    const qz = tx * e1y - ty * e1x;
    const v = dx * qx + dy * qy + dz * qz;
    if (v < -slack || u + v > det + slack) continue;
    const t = (e2x * qx + e2y * qy + e2z * qz) / det;
    if (t > 0 && t < nearest && accept(t)) {
      nearest = t;
      found = true;
    }
  }
  return found ? nearest : Number.POSITIVE_INFINITY;
}

/** Does the ray meet the box nearer than `limit`? */
export function meetsBox(
  min: Vec3,
  max: Vec3,
  origin: Vec3,
  direction: Vec3,
  limit = Number.POSITIVE_INFINITY,
): boolean {
  let low = 0;
  let high = limit;
  for (const i of [0, 1, 2] as const) {
    if (direction[i] === 0) {
      if (origin[i] < min[i] || origin[i] > max[i]) return false;
      continue;
    }
    const a = (min[i] - origin[i]) / direction[i];
    const b = (max[i] - origin[i]) / direction[i];
    low = Math.max(low, Math.min(a, b));
    high = Math.min(high, Math.max(a, b));
  }
  return low <= high;
}
