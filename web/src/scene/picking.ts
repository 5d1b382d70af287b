// The surface under a place of the canvas, from the meshes that are drawn.
import { Box3, type BufferAttribute, type BufferGeometry, InterleavedBufferAttribute, Matrix4, Vector3 } from "three";
import type { Vec3 } from "../base/vec.js";
import { boxHolds } from "./clip.js";
import { meetsBox, nearestHit, type Sides, type Triangles } from "./ray_mesh.js";
import type { Surface } from "./surface.js";
import type { Box } from "./world.js";

/** Copies of arrays that are not plain x, y, z; made once. */
const plain = new WeakMap<object, Float32Array>();

function positionsOf(attribute: BufferAttribute | InterleavedBufferAttribute): Float32Array {
  if (
    !(attribute instanceof InterleavedBufferAttribute) &&
    attribute.array instanceof Float32Array &&
    attribute.itemSize === 3
  ) {
    return attribute.array;
  }
  const known = plain.get(attribute);
  if (known !== undefined) return known;
  const copy = new Float32Array(3 * attribute.count);
  for (let i = 0; i < attribute.count; i += 1)
    copy.set([attribute.getX(i), attribute.getY(i), attribute.getZ(i)], 3 * i);
  plain.set(attribute, copy);
  return copy;
}

function trianglesOf(geometry: BufferGeometry): Triangles | null {
  const position = geometry.getAttribute("position");
  if (position === undefined) return null;
  const index = geometry.index?.array ?? null;
  if (index === null) return { positions: positionsOf(position), indices: null };
  if (index instanceof Uint16Array || index instanceof Uint32Array)
    return { positions: positionsOf(position), indices: index };
  return { positions: positionsOf(position), indices: Uint32Array.from(index) };
}

const inverse = new Matrix4();
const from = new Vector3();

function boxOf(geometry: BufferGeometry): Box3 {
  if (geometry.boundingBox === null) geometry.computeBoundingBox();
  return geometry.boundingBox ?? new Box3();
}

export interface PickOptions {
  /** Only what is inside counts; null: all. */
  readonly clip: Box | null;
  /** Farther away nothing counts. */
  readonly limit?: number;
  /** Which sides of triangles count. */
  readonly sides?: Sides;
}

/** Distance along the ray (scene coordinates, unit direction) to the first mesh; null: none. */
export function pickMeshes(
  sources: readonly Pick<Surface, "eachMesh">[],
  origin: Vec3,
  direction: Vec3,
  { clip, limit = Number.POSITIVE_INFINITY, sides = "front" }: PickOptions,
): number | null {
  let nearest = limit;
  let found = false;
  const accept =
    clip === null
      ? undefined
      : (t: number) =>
          boxHolds(clip, [origin[0] + t * direction[0], origin[1] + t * direction[1], origin[2] + t * direction[2]]);
  for (const source of sources) {
    source.eachMesh((mesh, geometry) => {
      // The direction keeps its length in metres of the scene, so t is the same in both frames.
      inverse.copy(mesh.matrixWorld).invert();
      const e = inverse.elements;
      const turned = (i: number) =>
        (e[i] ?? 0) * direction[0] + (e[i + 4] ?? 0) * direction[1] + (e[i + 8] ?? 0) * direction[2];
      const localDirection: Vec3 = [turned(0), turned(1), turned(2)];
      from.set(...origin).applyMatrix4(inverse);
      const localOrigin: Vec3 = [from.x, from.y, from.z];
      const { min, max } = boxOf(geometry);
      // A flat box must still be met.
      const grown = 1e-3;
      const low: Vec3 = [min.x - grown, min.y - grown, min.z - grown];
      const high: Vec3 = [max.x + grown, max.y + grown, max.z + grown];
      if (!meetsBox(low, high, localOrigin, localDirection, nearest)) return;
      const triangles = trianglesOf(geometry);
      if (triangles === null) return;
      const t = nearestHit(triangles, localOrigin, localDirection, nearest, accept, sides);
      if (!Number.isFinite(t)) return;
      nearest = t;
      found = true;
    });
  }
  return found ? nearest : null;
}

/** The same for surfaces, of which only the front counts. */
export function pickSurfaces(
  surfaces: readonly Surface[],
  origin: Vec3,
  direction: Vec3,
  clip: Box | null,
  limit = Number.POSITIVE_INFINITY,
): number | null {
  return pickMeshes(surfaces, origin, direction, { clip, limit });
}
