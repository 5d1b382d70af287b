// What is solid, for ways that keep a distance from it: a grid of columns without gaps between them, each filled from below up to its height. A column
// covers its whole cell, so that steep walls are where they are at the latest. Cells without surface (NaN) and everything outside the grid are empty.
// ENU, metres, doubles. Nothing here changes a grid once it is made.
import type { Vec2 } from "../base/vec.js";

export interface HeightCells {
  /** South-western corner of the grid. */
  readonly min: Vec2;
  /** Size of a cell along x and y. */
  readonly cellM: Vec2;
  readonly columns: number;
  readonly rows: number;
  /** Top of each column, row by row from the south-west; NaN: no surface. */
  readonly z: Float64Array;
}

/** Of an empty place: below everything. */
export const NOTHING = Number.NEGATIVE_INFINITY;

export class Heights {
  readonly min: Vec2;
  readonly max: Vec2;
  readonly cellM: Vec2;
  private readonly columns: number;
  private readonly rows: number;
  private readonly z: Float64Array;

  constructor({ min, cellM, columns, rows, z }: HeightCells) {
    const whole = Number.isSafeInteger(columns) && Number.isSafeInteger(rows) && columns >= 1 && rows >= 1;
    if (!whole || z.length !== columns * rows || !min.every(Number.isFinite)) {
      throw new Error(`heights: ${columns} x ${rows} cells do not fit ${z.length} numbers`);
    }
    if (!cellM.every((size) => Number.isFinite(size) && size > 0)) throw new Error("heights: cells without size");
    this.min = min;
    this.cellM = cellM;
    this.max = [min[0] + columns * cellM[0], min[1] + rows * cellM[1]];
    this.columns = columns;
    this.rows = rows;
    this.z = z;
  }

  /** Top of the column here; null: no surface. */
  at(x: number, y: number): number | null {
    const column = Math.floor((x - this.min[0]) / this.cellM[0]);
    const row = Math.floor((y - this.min[1]) / this.cellM[1]);
    if (!(column >= 0 && column < this.columns && row >= 0 && row < this.rows)) return null;
    const z = this.z[row * this.columns + column] ?? Number.NaN;
    return Number.isNaN(z) ? null : z;
  }

  /** Highest top of a column that comes nearer in plan than `radiusM`; NOTHING: there is none. */
  highest(x: number, y: number, radiusM: number): number {
    return this.strongest(x, y, radiusM, (z) => z);
  }

  /**
   * The lowest z from which up every point here is at least `radiusM` away from what is solid. With `slackM` the same for all places that are not
   * farther than this from here, or a little more. NOTHING: all heights are free.
   */
  dilated(x: number, y: number, radiusM: number, slackM = 0): number {
    const square = radiusM * radiusM;
    return this.strongest(x, y, radiusM + slackM, (z, distanceM) => {
      const d = Math.max(0, distanceM - slackM);
      return z + Math.sqrt(square - d * d);
    });
  }

  /** No column is that near in plan, so there is nothing to ask. */
  isFar(x: number, y: number, radiusM: number): boolean {
    return (
      !(x + radiusM > this.min[0] && x - radiusM < this.max[0]) ||
      !(y + radiusM > this.min[1] && y - radiusM < this.max[1])
    );
  }

  private strongest(x: number, y: number, radiusM: number, of: (z: number, distanceM: number) => number): number {
    let best = NOTHING;
    if (this.isFar(x, y, radiusM)) return best;
    const [sizeX, sizeY] = this.cellM;
    const [fromX, fromY] = [x - this.min[0], y - this.min[1]];
    const firstColumn = Math.max(0, Math.floor((fromX - radiusM) / sizeX));
    const lastColumn = Math.min(this.columns - 1, Math.floor((fromX + radiusM) / sizeX));
    const firstRow = Math.max(0, Math.floor((fromY - radiusM) / sizeY));
    const lastRow = Math.min(this.rows - 1, Math.floor((fromY + radiusM) / sizeY));
    for (let row = firstRow; row <= lastRow; row += 1) {
      const dy = Math.max(0, row * sizeY - fromY, fromY - (row + 1) * sizeY);
      for (let column = firstColumn; column <= lastColumn; column += 1) {
        const z = this.z[row * this.columns + column] ?? Number.NaN;
        // Also passes over NaN. No height that this column can give exceeds this.
        if (!(z + radiusM > best)) continue;
        const dx = Math.max(0, column * sizeX - fromX, fromX - (column + 1) * sizeX);
        const distanceM = Math.sqrt(dx * dx + dy * dy);
        if (distanceM < radiusM) best = Math.max(best, of(z, distanceM));
      }
    }
    return best;
  }
}
