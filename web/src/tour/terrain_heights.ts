// Heights from a surface model as a grid of points (terrain.bin). The points lie on a map's grid, which is turned against ENU by the convergence of
// meridians, and the drawn surface passes between them. Each point therefore raises all cells that a triangle with this corner can touch, so that the
// columns hold the drawn surface, at the price of making walls up to a cell thicker.
import type { Vec2, Vec3 } from "../base/vec.js";
import { Heights } from "./heights.js";

/** What TerrainGrid of scene/terrain_grid.ts has. */
export interface TerrainPoints {
  readonly columns: number;
  readonly rows: number;
  readonly anchor: Vec3;
  /** x, y, z minus the anchor per point, row by row from the north-west; NaN: no surface. */
  readonly points: Float32Array;
}

/** Share of a cell that the rounding of points to floats may have moved them. */
const ROUNDING = 1e-3;
const MOST_CELLS = 1 << 24;

/** Steps in ENU from a point to the next of its row and of its column. */
interface Lattice {
  readonly perColumn: Vec2;
  readonly perRow: Vec2;
}

/** Null: the surface model has no point. */
export function heightsFromTerrain(terrain: TerrainPoints): Heights | null {
  const { columns, rows, anchor, points } = terrain;
  const lattice = fitLattice(terrain);
  if (lattice === null) return null;
  const { perColumn, perRow } = lattice;
  const cellM: Vec2 = [Math.hypot(...perColumn), Math.hypot(...perRow)];
  // Half the box of the four meshes around a point; one cell to each side when the grid is not turned.
  const reach: Vec2 = [
    Math.abs(perColumn[0]) + Math.abs(perRow[0]) - ROUNDING * cellM[0],
    Math.abs(perColumn[1]) + Math.abs(perRow[1]) - ROUNDING * cellM[1],
  ];
  let [minX, minY, maxX, maxY] = [Infinity, Infinity, -Infinity, -Infinity];
  eachPoint(terrain, (x, y) => {
    minX = Math.min(minX, x);
    maxX = Math.max(maxX, x);
    minY = Math.min(minY, y);
    maxY = Math.max(maxY, y);
  });
  // Cells begin at points, so that a grid that is not turned keeps its own.
  const corner: Vec2 = [
    minX - Math.ceil(reach[0] / cellM[0]) * cellM[0],
    minY - Math.ceil(reach[1] / cellM[1]) * cellM[1],
  ];
  const wide = Math.floor((maxX + reach[0] - corner[0]) / cellM[0]) + 1;
  const high = Math.floor((maxY + reach[1] - corner[1]) / cellM[1]) + 1;
  if (
    !(wide >= 1 && high >= 1 && wide * high <= Math.min(MOST_CELLS, 4 * (columns + 3) * (rows + 3) + points.length))
  ) {
    throw new Error("the surface model is damaged: its points are not a grid");
  }
  const z = new Float64Array(wide * high).fill(Number.NaN);
  eachPoint(terrain, (x, y, height) => {
    const [dx, dy] = [x - corner[0], y - corner[1]];
    const firstColumn = Math.max(0, Math.floor((dx - reach[0]) / cellM[0]));
    const lastColumn = Math.min(wide - 1, Math.floor((dx + reach[0]) / cellM[0]));
    const firstRow = Math.max(0, Math.floor((dy - reach[1]) / cellM[1]));
    const lastRow = Math.min(high - 1, Math.floor((dy + reach[1]) / cellM[1]));
    for (let row = firstRow; row <= lastRow; row += 1) {
      for (let column = firstColumn; column <= lastColumn; column += 1) {
        const i = row * wide + column;
        // NaN is not above anything either.
        if (!((z[i] ?? 0) >= height + anchor[2])) z[i] = height + anchor[2];
      }
    }
  });
  return new Heights({ min: [corner[0] + anchor[0], corner[1] + anchor[1]], cellM, columns: wide, rows: high, z });
}

type Visit = (x: number, y: number, z: number, column: number, row: number) => void;

/** Points with a surface, relative to the anchor. */
function eachPoint({ columns, rows, points }: TerrainPoints, visit: Visit): void {
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      const at = 3 * (row * columns + column);
      const x = points[at] ?? Number.NaN;
      const y = points[at + 1] ?? Number.NaN;
      const z = points[at + 2] ?? Number.NaN;
      if (Number.isFinite(x) && Number.isFinite(y) && Number.isFinite(z)) visit(x, y, z, column, row);
    }
  }
}

/** Least squares over all points. Points of one row or column give one step, and the other one is as long and at right angles to it. */
function fitLattice(terrain: TerrainPoints): Lattice | null {
  const sums = { n: 0, c: 0, r: 0, x: 0, y: 0 };
  eachPoint(terrain, (x, y, _z, column, row) => {
    sums.n += 1;
    sums.c += column;
    sums.r += row;
    sums.x += x;
    sums.y += y;
  });
  if (sums.n === 0) return null;
  const middle = { c: sums.c / sums.n, r: sums.r / sums.n, x: sums.x / sums.n, y: sums.y / sums.n };
  let [cc, cr, rr, cx, cy, rx, ry] = [0, 0, 0, 0, 0, 0, 0];
  eachPoint(terrain, (x, y, _z, column, row) => {
    const [c, r] = [column - middle.c, row - middle.r];
    const [dx, dy] = [x - middle.x, y - middle.y];
    cc += c * c;
    cr += c * r;
    rr += r * r;
    cx += c * dx;
    cy += c * dy;
    rx += r * dx;
    ry += r * dy;
  });
  const determinant = cc * rr - cr * cr;
  let perColumn: Vec2;
  let perRow: Vec2;
  if (determinant > 1e-9 * cc * rr) {
    perColumn = [(rr * cx - cr * rx) / determinant, (rr * cy - cr * ry) / determinant];
    perRow = [(cc * rx - cr * cx) / determinant, (cc * ry - cr * cy) / determinant];
  } else if (cc >= rr && cc > 0) {
    perColumn = [cx / cc, cy / cc];
    perRow = [perColumn[1], -perColumn[0]];
  } else if (rr > 0) {
    perRow = [rx / rr, ry / rr];
    perColumn = [-perRow[1], perRow[0]];
  } else {
    // One point says nothing of its surroundings: a metre to each side.
    perColumn = [1, 0];
    perRow = [0, -1];
  }
  const usable = Math.hypot(...perColumn) > 0 && Math.hypot(...perRow) > 0;
  if (!usable) throw new Error("the surface model is damaged: its points are not a grid");
  return { perColumn, perRow };
}
