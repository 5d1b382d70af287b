// A textured mesh with fewer triangles, for motion on slow graphics: all vertices in a cell of a grid become one. Parts of the texture (charts) keep
// vertices of their own in a cell, but at one common place, so that no gaps open between them.
import type { Triangles } from "./ray_mesh.js";

export interface TexturedTriangles extends Triangles {
  /** u, v per vertex. */
  readonly uvs: Float32Array;
}

/** For each vertex one that stands for its chart: vertices that triangles connect have the same. */
function chartsOf(count: number, indices: Uint16Array | Uint32Array): Int32Array {
  const parent = Int32Array.from({ length: count }, (_, i) => i);
  const root = (vertex: number): number => {
    let at = vertex;
    for (let above = parent[at] ?? at; above !== at; above = parent[at] ?? at) {
      const next = parent[above] ?? above;
      parent[at] = next;
      at = next;
    }
    return at;
  };
  for (let i = 0; i + 2 < indices.length; i += 3) {
    const first = root(indices[i] ?? 0);
    parent[root(indices[i + 1] ?? 0)] = first;
    parent[root(indices[i + 2] ?? 0)] = first;
  }
  for (let i = 0; i < count; i += 1) parent[i] = root(i);
  return parent;
}

/** Null when it would not become much smaller. Frame and unit of `cell` are those of the positions. */
export function makeCoarse(mesh: TexturedTriangles, cell: number): TexturedTriangles | null {
  const { positions, uvs, indices } = mesh;
  const count = Math.floor(positions.length / 3);
  if (indices === null || !(cell > 0) || count === 0 || uvs.length < 2 * count) return null;
  const low = [Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY] as [
    number,
    number,
    number,
  ];
  const high = [Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY] as [
    number,
    number,
    number,
  ];
  for (let i = 0; i < 3 * count; i += 1) {
    const axis = i % 3;
    const value = positions[i] ?? 0;
    if (value < (low[axis] ?? 0)) low[axis] = value;
    if (value > (high[axis] ?? 0)) high[axis] = value;
  }
  const across = [0, 1, 2].map((axis) => Math.floor(((high[axis] ?? 0) - (low[axis] ?? 0)) / cell) + 1);
  const [nx = 1, ny = 1, nz = 1] = across;
  // Keys below must be whole numbers without rounding.
  if (!(nx * ny * nz * count < Number.MAX_SAFE_INTEGER)) return null;
  const charts = chartsOf(count, indices);
  const cells = new Map<number, number>();
  const made = new Map<number, number>();
  /** Sums of x, y, z and how many. */
  const places: number[] = [];
  /** Sums of u, v, how many, and the cell. */
  const vertices: number[] = [];
  const mapped = new Uint32Array(count);
  for (let i = 0; i < count; i += 1) {
    const [x, y, z] = [positions[3 * i] ?? 0, positions[3 * i + 1] ?? 0, positions[3 * i + 2] ?? 0];
    const column = Math.floor((x - low[0]) / cell);
    const key = (column * ny + Math.floor((y - low[1]) / cell)) * nz + Math.floor((z - low[2]) / cell);
    let place = cells.get(key);
    if (place === undefined) {
      place = places.length / 4;
      cells.set(key, place);
      places.push(0, 0, 0, 0);
    }
    add(places, 4 * place, [x, y, z, 1]);
    const own = place * count + (charts[i] ?? 0);
    let vertex = made.get(own);
    if (vertex === undefined) {
      vertex = vertices.length / 4;
      made.set(own, vertex);
      vertices.push(0, 0, 0, place);
    }
    add(vertices, 4 * vertex, [uvs[2 * i] ?? 0, uvs[2 * i + 1] ?? 0, 1]);
    mapped[i] = vertex;
  }
  const kept = new Uint32Array(indices.length);
  let used = 0;
  const cellOf = (vertex: number) => vertices[4 * vertex + 3] ?? 0;
  for (let i = 0; i + 2 < indices.length; i += 3) {
    const [a, b, c] = [
      mapped[indices[i] ?? 0] ?? 0,
      mapped[indices[i + 1] ?? 0] ?? 0,
      mapped[indices[i + 2] ?? 0] ?? 0,
    ];
    if (cellOf(a) === cellOf(b) || cellOf(b) === cellOf(c) || cellOf(a) === cellOf(c)) continue;
    kept[used] = a;
    kept[used + 1] = b;
    kept[used + 2] = c;
    used += 3;
  }
  if (used > 0.8 * indices.length) return null;
  return { ...averages(places, vertices), indices: kept.slice(0, used) };
}

function add(target: number[], at: number, values: readonly number[]): void {
  for (const [i, value] of values.entries()) target[at + i] = (target[at + i] ?? 0) + value;
}

function averages(
  places: readonly number[],
  vertices: readonly number[],
): { positions: Float32Array; uvs: Float32Array } {
  const count = vertices.length / 4;
  const positions = new Float32Array(3 * count);
  const uvs = new Float32Array(2 * count);
  for (let i = 0; i < count; i += 1) {
    const place = 4 * (vertices[4 * i + 3] ?? 0);
    const members = places[place + 3] ?? 1;
    for (let k = 0; k < 3; k += 1) positions[3 * i + k] = (places[place + k] ?? 0) / members;
    const own = vertices[4 * i + 2] ?? 1;
    for (let k = 0; k < 2; k += 1) uvs[2 * i + k] = (vertices[4 * i + k] ?? 0) / own;
  }
  return { positions, uvs };
}
