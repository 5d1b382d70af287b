// Random terrains with towers, walls and holes, and the distance to them by brute force, independent of what the planner uses.
import type { Vec2, Vec3 } from "../../../src/base/vec.js";
import { type HeightCells, Heights } from "../../../src/tour/heights.js";

/** Mulberry32: 0 to 1, the same numbers for the same seed. */
export function random(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = state;
    t = Math.imul(t ^ (t >>> 15), t | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

export interface Terrain {
  readonly cells: HeightCells;
  readonly heights: Heights;
}

export function terrainOf(
  columns: number,
  rows: number,
  z: (column: number, row: number) => number,
  cellM: Vec2 = [1, 1],
  min: Vec2 = [0, 0],
): Terrain {
  const values = Float64Array.from({ length: columns * rows }, (_, i) => z(i % columns, Math.floor(i / columns)));
  const cells = { min, cellM, columns, rows, z: values };
  return { cells, heights: new Heights(cells) };
}

/** Hills, towers, long walls, and places without surface. */
export function randomTerrain(seed: number): Terrain {
  const next = random(seed);
  const columns = 20 + Math.floor(next() * 40);
  const rows = 20 + Math.floor(next() * 40);
  const cellM: Vec2 = next() < 0.5 ? [1, 1] : [0.3 + 2 * next(), 0.3 + 2 * next()];
  const [hill, waves] = [10 * next(), 2 + 6 * next()];
  const values = new Map<number, number>();
  const set = (column: number, row: number, z: number) => values.set(row * columns + column, z);
  for (let tower = Math.floor(next() * 40); tower > 0; tower -= 1) {
    const [c, r, top] = [Math.floor(next() * columns), Math.floor(next() * rows), 5 + 40 * next()];
    const [wide, deep] = [1 + Math.floor(next() * 5), 1 + Math.floor(next() * 5)];
    for (let i = 0; i < wide * deep; i += 1) set(c + (i % wide), r + Math.floor(i / wide), top);
  }
  for (let wall = Math.floor(next() * 4); wall > 0; wall -= 1) {
    const [c, top] = [Math.floor(next() * columns), 3 + 15 * next()];
    for (let r = 0; r < rows; r += 1) if (next() < 0.95) set(c, r, top);
  }
  for (let hole = Math.floor(next() * 100); hole > 0; hole -= 1) {
    set(Math.floor(next() * columns), Math.floor(next() * rows), Number.NaN);
  }
  return terrainOf(
    columns,
    rows,
    (column, row) => values.get(row * columns + column) ?? hill * Math.sin(column / waves) * Math.cos(row / waves),
    cellM,
    [-500 * next(), 1000 * next()],
  );
}

/** Somewhere over the terrain or beside it, often close to the ground. */
export function randomEye({ cells, heights }: Terrain, next: () => number): Vec3 {
  const size = [cells.columns * cells.cellM[0], cells.rows * cells.cellM[1]] as const;
  const x = cells.min[0] + size[0] * (1.2 * next() - 0.1);
  const y = cells.min[1] + size[1] * (1.2 * next() - 0.1);
  const up = next() < 0.7 ? 0.2 + 3 * next() : 60 * next();
  return [x, y, (heights.at(x, y) ?? 0) + up];
}

/** To the nearest column: 0 inside. Only those that come within `reachM` count. */
export function distanceToSolid({ min, cellM, columns, rows, z }: HeightCells, [x, y, up]: Vec3, reachM = 2): number {
  let nearest = Number.POSITIVE_INFINITY;
  const range = (at: number, size: number, count: number): [number, number] => [
    Math.max(0, Math.floor((at - reachM) / size) - 1),
    Math.min(count - 1, Math.floor((at + reachM) / size) + 1),
  ];
  const [c0, c1] = range(x - min[0], cellM[0], columns);
  const [r0, r1] = range(y - min[1], cellM[1], rows);
  for (let r = r0; r <= r1; r += 1) {
    for (let c = c0; c <= c1; c += 1) {
      const top = z[r * columns + c] ?? Number.NaN;
      if (Number.isNaN(top)) continue;
      const [west, south] = [min[0] + c * cellM[0], min[1] + r * cellM[1]];
      const dx = Math.max(0, west - x, x - west - cellM[0]);
      const dy = Math.max(0, south - y, y - south - cellM[1]);
      nearest = Math.min(nearest, Math.hypot(dx, dy, Math.max(0, up - top)));
    }
  }
  return nearest;
}
