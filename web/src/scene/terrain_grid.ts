// terrain.bin (docs/viewer_protocol.md): a surface model as a grid of points, and parts of it as triangles with holes where there is none.
import type { Vec2, Vec3 } from "../base/vec.js";

const HEAD_BYTES = 8 + 2 * 4 + 3 * 8;
const MOST_VERTICES = 1 << 24;

export interface TerrainGrid {
  readonly columns: number;
  readonly rows: number;
  /** What was subtracted from the points, in the project's own ENU. */
  readonly anchor: Vec3;
  /** x, y, z per point, row by row from the north-west; NaN: no surface. */
  readonly points: Float32Array;
}

export interface TerrainPatch {
  readonly positions: Float32Array;
  /** Of the orthophoto, from its upper left corner. */
  readonly uvs: Float32Array;
  readonly normals: Float32Array;
  readonly indices: Uint32Array;
}

function hasMagic(bytes: ArrayBuffer, magic: string): boolean {
  const head = new Uint8Array(bytes, 0, Math.min(8, bytes.byteLength));
  return head.length === 8 && String.fromCharCode(...head) === magic;
}

export function parseTerrain(bytes: ArrayBuffer): TerrainGrid {
  if (bytes.byteLength < HEAD_BYTES || !hasMagic(bytes, "SKYTERR1"))
    throw new Error("the surface model is damaged: it does not begin with SKYTERR1");
  const view = new DataView(bytes);
  const columns = view.getUint32(8, true);
  const rows = view.getUint32(12, true);
  const anchor: Vec3 = [view.getFloat64(16, true), view.getFloat64(24, true), view.getFloat64(32, true)];
  const count = columns * rows;
  if (columns < 2 || rows < 2 || count > MOST_VERTICES || bytes.byteLength !== HEAD_BYTES + 12 * count) {
    throw new Error(
      `the surface model is damaged: ${columns} x ${rows} points do not fit its ${bytes.byteLength} bytes`,
    );
  }
  if (!anchor.every(Number.isFinite)) throw new Error("the surface model is damaged: its anchor is not a number");
  return { columns, rows, anchor, points: new Float32Array(bytes, HEAD_BYTES, 3 * count) };
}

/** The step (in cells) at which the grid has at most this many triangles. */
export function stepFor(grid: TerrainGrid, mostTriangles: number): number {
  let step = 1;
  while (2 * Math.ceil((grid.columns - 1) / step) * Math.ceil((grid.rows - 1) / step) > mostTriangles) step += 1;
  return step;
}

/** 0, step, 2 step, ... and always `last`. */
function places(first: number, last: number, step: number): number[] {
  const list: number[] = [];
  for (let i = first; i < last; i += step) list.push(i);
  list.push(last);
  return list;
}

/** Corner columns and rows (inclusive) of parts of about `cells` steps, which meet without gaps. */
export function patchesOf(grid: TerrainGrid, step: number, cells = 64): { readonly from: Vec2; readonly to: Vec2 }[] {
  const patches: { from: Vec2; to: Vec2 }[] = [];
  const side = step * cells;
  for (let row = 0; row < grid.rows - 1; row += side) {
    for (let column = 0; column < grid.columns - 1; column += side) {
      patches.push({
        from: [column, row],
        to: [Math.min(grid.columns - 1, column + side), Math.min(grid.rows - 1, row + side)],
      });
    }
  }
  return patches;
}

/** Triangles between the points of a part; counter-clockwise from above. Null: it has no surface. */
export function makePatch(grid: TerrainGrid, from: Vec2, to: Vec2, step: number): TerrainPatch | null {
  const columns = places(from[0], to[0], step);
  const rows = places(from[1], to[1], step);
  const count = columns.length * rows.length;
  const positions = new Float32Array(3 * count);
  const uvs = new Float32Array(2 * count);
  const normals = new Float32Array(3 * count);
  const there = new Uint8Array(count);
  let at = 0;
  for (const row of rows) {
    for (const column of columns) {
      const source = 3 * (row * grid.columns + column);
      const x = grid.points[source] ?? Number.NaN;
      const y = grid.points[source + 1] ?? Number.NaN;
      const z = grid.points[source + 2] ?? Number.NaN;
      if (Number.isFinite(x) && Number.isFinite(y) && Number.isFinite(z)) {
        positions.set([x, y, z], 3 * at);
        there[at] = 1;
      }
      uvs[2 * at] = column / (grid.columns - 1);
      uvs[2 * at + 1] = row / (grid.rows - 1);
      at += 1;
    }
  }
  const indices = new Uint32Array(6 * (columns.length - 1) * (rows.length - 1));
  let used = 0;
  const put = (a: number, b: number, c: number): void => {
    if (there[a] !== 1 || there[b] !== 1 || there[c] !== 1) return;
    indices.set([a, b, c], used);
    used += 3;
    addNormal(positions, normals, a, b, c);
  };
  for (let row = 0; row + 1 < rows.length; row += 1) {
    for (let column = 0; column + 1 < columns.length; column += 1) {
      const a = row * columns.length + column;
      const [b, c, d] = [a + 1, a + columns.length, a + columns.length + 1];
      // With one corner missing, the triangle of the other three stays.
      if (there[a] === 1 && there[d] === 1) {
        put(a, c, d);
        put(a, d, b);
      } else {
        put(a, c, b);
        put(b, c, d);
      }
    }
  }
  if (used === 0) return null;
  // Points without a surface: on a neighbour's place, so that they do not widen the bounding box.
  const anchor = indices[0] ?? 0;
  const place = positions.slice(3 * anchor, 3 * anchor + 3);
  for (let i = 0; i < count; i += 1) if (there[i] !== 1) positions.set(place, 3 * i);
  return { positions, uvs, normals, indices: indices.slice(0, used) };
}

function addNormal(positions: Float32Array, normals: Float32Array, a: number, b: number, c: number): void {
  const get = (vertex: number, i: number) => positions[3 * vertex + i] ?? 0;
  const [ux, uy, uz] = [get(b, 0) - get(a, 0), get(b, 1) - get(a, 1), get(b, 2) - get(a, 2)];
  const [vx, vy, vz] = [get(c, 0) - get(a, 0), get(c, 1) - get(a, 1), get(c, 2) - get(a, 2)];
  const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  for (const vertex of [a, b, c])
    for (let i = 0; i < 3; i += 1) normals[3 * vertex + i] = (normals[3 * vertex + i] ?? 0) + (n[i] ?? 0);
}

/** Grey values for light from the north-west, where there is no orthophoto. */
export function shade(normals: Float32Array): Float32Array {
  const colours = new Float32Array(normals.length);
  for (let i = 0; i + 2 < normals.length; i += 3) {
    const [x, y, z] = [normals[i] ?? 0, normals[i + 1] ?? 0, normals[i + 2] ?? 0];
    const length = Math.hypot(x, y, z);
    const light = length > 0 ? Math.max(0, (-0.5 * x + 0.5 * y + Math.SQRT1_2 * z) / length) : 0.7;
    colours.fill(0.25 + 0.65 * light, i, i + 3);
  }
  return colours;
}
