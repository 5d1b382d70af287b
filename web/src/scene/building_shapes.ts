// Solids as arrays for the graphics card, ENU minus an anchor: triangles of faces, which may have holes, and edges.
import { ShapeUtils, Vector2 } from "three";
import type { Vec3 } from "../base/vec.js";
import { cross, dot, norm, scale, sub } from "../base/vec_math.js";
import type { Face, FaceKind, Solid } from "../state/buildings.js";

/** The area of the ring as a vector along its normal (Newell). */
function areaVector(ring: readonly Vec3[]): Vec3 {
  const first = ring[0] ?? [0, 0, 0];
  let [x, y, z] = [0, 0, 0];
  for (const [i, b] of ring.entries()) {
    const c = cross(sub(b, first), sub(ring[(i + 1) % ring.length] ?? b, first));
    x += c[0] / 2;
    y += c[1] / 2;
    z += c[2] / 2;
  }
  return [x, y, z];
}

/** Corners one after the other, without repeats, which the triangulation would take out and so shift all numbers. */
function withoutRepeats(ring: readonly number[]): number[] {
  return ring.filter((vertex, i) => vertex !== ring[(i + ring.length - 1) % ring.length]);
}

/** Numbers of vertices, three per triangle, turned as the face is; empty when the face has no area. */
export function triangulateFace(vertices: readonly Vec3[], face: Face): number[] {
  const rings = face.rings.map(withoutRepeats).filter((ring) => ring.length >= 3);
  const corner = (vertex: number): Vec3 => vertices[vertex] ?? [0, 0, 0];
  const outer = (rings[0] ?? []).map(corner);
  const area = areaVector(outer);
  const size = norm(area);
  if (!(size > 0)) return [];
  const normal = scale(area, 1 / size);
  // Two axes of the face's plane; the one that is least along the normal makes the first.
  const least = [0, 1, 2].sort((i, j) => Math.abs(normal[i] ?? 0) - Math.abs(normal[j] ?? 0))[0];
  const along: Vec3 = [least === 0 ? 1 : 0, least === 1 ? 1 : 0, least === 2 ? 1 : 0];
  const u = cross(along, normal);
  const e1 = scale(u, 1 / norm(u));
  const e2 = cross(normal, e1);
  const origin = outer[0] ?? [0, 0, 0];
  const flat = (ring: readonly number[]) =>
    ring.map((vertex) => {
      const d = sub(corner(vertex), origin);
      return new Vector2(dot(d, e1), dot(d, e2));
    });
  const [contour = [], ...holes] = rings.map(flat);
  const numbers = rings.flat();
  return ShapeUtils.triangulateShape(contour, holes).flatMap((triangle) => {
    const [a = 0, b = 0, c = 0] = triangle.map((i) => numbers[i] ?? 0);
    const turned = dot(areaVector([corner(a), corner(b), corner(c)]), normal);
    return turned === 0 ? [] : turned > 0 ? [a, b, c] : [a, c, b];
  });
}

export interface SolidMesh {
  /** x, y, z of three corners per triangle. */
  readonly positions: Float32Array;
  /** One per triangle. */
  readonly kinds: readonly FaceKind[];
}

export function solidMesh(solid: Solid, anchor: Vec3): SolidMesh {
  const positions: number[] = [];
  const kinds: FaceKind[] = [];
  for (const face of solid.faces) {
    const corners = triangulateFace(solid.vertices, face);
    for (const vertex of corners) positions.push(...sub(solid.vertices[vertex] ?? anchor, anchor));
    for (let i = 0; i < corners.length; i += 3) kinds.push(face.kind);
  }
  return { positions: Float32Array.from(positions), kinds };
}

/** Both ends of each edge, once for the two faces that share it. */
export function solidEdges(solid: Solid, anchor: Vec3): Float32Array {
  const known = new Set<string>();
  const positions: number[] = [];
  for (const ring of solid.faces.flatMap(({ rings }) => rings)) {
    for (const [i, a] of ring.entries()) {
      const b = ring[(i + 1) % ring.length] ?? a;
      const name = a < b ? `${a} ${b}` : `${b} ${a}`;
      if (a === b || known.has(name)) continue;
      known.add(name);
      for (const vertex of [a, b]) positions.push(...sub(solid.vertices[vertex] ?? anchor, anchor));
    }
  }
  return Float32Array.from(positions);
}
