// Where the orthophoto lies: from the first to the last column and row of points of the surface model, whose grid may be turned against ENU.
import type { Vec2 } from "../base/vec.js";
import type { TerrainGrid } from "../scene/terrain_grid.js";
import type { GroundMap } from "../state/tour_state.js";

interface Known {
  readonly column: number;
  readonly row: number;
  readonly at: Vec2;
}

/** Null: there is no picture, or too few points to tell. */
export function groundMap(terrain: TerrainGrid, url: string | null): GroundMap | null {
  if (url === null) return null;
  const { columns, rows, anchor } = terrain;
  const [west, east] = extremes(terrain, ({ column }) => column);
  const [north, south] = extremes(terrain, ({ row }) => row);
  if (west === null || east === null || north === null || south === null) return null;
  // Both differences by column and row; they are those of the grid's steps.
  const [c1, r1, d1] = difference(west, east);
  const [c2, r2, d2] = difference(north, south);
  const determinant = c1 * r2 - c2 * r1;
  if (determinant === 0) return null;
  const step = (a: number, b: number): Vec2 => [
    (a * d1[0] + b * d2[0]) / determinant,
    (a * d1[1] + b * d2[1]) / determinant,
  ];
  const perColumn = step(r2, -r1);
  const perRow = step(-c2, c1);
  const corner = (axis: 0 | 1) =>
    anchor[axis] + west.at[axis] - west.column * perColumn[axis] - west.row * perRow[axis];
  return {
    url,
    corner: [corner(0), corner(1)],
    across: [perColumn[0] * (columns - 1), perColumn[1] * (columns - 1)],
    down: [perRow[0] * (rows - 1), perRow[1] * (rows - 1)],
  };
}

function difference(a: Known, b: Known): readonly [columns: number, rows: number, metres: Vec2] {
  return [b.column - a.column, b.row - a.row, [b.at[0] - a.at[0], b.at[1] - a.at[1]]];
}

/** The points with the least and the greatest value. */
function extremes(
  { columns, rows, points }: TerrainGrid,
  value: (known: Known) => number,
): readonly [Known | null, Known | null] {
  let [least, most]: [Known | null, Known | null] = [null, null];
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      const i = 3 * (row * columns + column);
      const at: Vec2 = [points[i] ?? Number.NaN, points[i + 1] ?? Number.NaN];
      if (!at.every(Number.isFinite)) continue;
      const known = { column, row, at };
      if (least === null || value(known) < value(least)) least = known;
      if (most === null || value(known) > value(most)) most = known;
    }
  }
  return [least, most];
}
