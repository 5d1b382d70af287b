import assert from "node:assert/strict";
import test from "node:test";
import { groundMap } from "../../../src/entry/ground_map.js";

const STEP = [0.5, 0.02] as const;
const DOWN = [0.02, -0.5] as const;

/** A grid turned against ENU by the convergence of meridians. */
function grid(columns: number, rows: number, known: (column: number, row: number) => boolean) {
  const points = new Float32Array(3 * columns * rows).fill(Number.NaN);
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      if (!known(column, row)) continue;
      const at = [-8 + column * STEP[0] + row * DOWN[0], 6 + column * STEP[1] + row * DOWN[1], 1];
      points.set(at, 3 * (row * columns + column));
    }
  }
  return { columns, rows, anchor: [1000, 2000, 30] as const, points };
}

test("the picture's corner and sides come out of the points, also when its corners have none", () => {
  const expected = { corner: [992, 2006], across: [10, 0.4], down: [0.6, -15] };
  for (const known of [() => true, (column: number, row: number) => Math.hypot(column - 10, row - 15) < 9]) {
    const map = groundMap(grid(21, 31, known), "x.jpg") ?? assert.fail();
    for (const part of ["corner", "across", "down"] as const) {
      for (const axis of [0, 1] as const) {
        const off = Math.abs(map[part][axis] - (expected[part][axis] ?? 0));
        assert.ok(off < 1e-3, `${part} ${axis}: ${map[part][axis]}`);
      }
    }
  }
});

test("without a picture, without points or with one row of them there is no map", () => {
  assert.equal(
    groundMap(
      grid(5, 5, () => true),
      null,
    ),
    null,
  );
  assert.equal(
    groundMap(
      grid(5, 5, () => false),
      "x.jpg",
    ),
    null,
  );
  assert.equal(
    groundMap(
      grid(5, 5, (_, row) => row === 2),
      "x.jpg",
    ),
    null,
  );
});
