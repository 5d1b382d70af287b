import assert from "node:assert/strict";
import { test } from "node:test";
import { type GridInput, makeDepthGrid } from "../../../src/scene/depth_grid.js";

function input(
  depthWidth: number,
  depthHeight: number,
  z: (i: number, j: number) => number,
  ortho: number | null = null,
): GridInput {
  const depthM = new Float32Array(depthWidth * depthHeight);
  for (let j = 0; j < depthHeight; j += 1) for (let i = 0; i < depthWidth; i += 1) depthM[j * depthWidth + i] = z(i, j);
  return {
    width: 2 * depthWidth,
    height: 2 * depthHeight,
    depthWidth,
    depthHeight,
    depthM,
    fovyDeg: ortho === null ? 60 : null,
    orthoHeightM: ortho,
  };
}

function cells(grid: { indices: Uint32Array }): number {
  return grid.indices.length / 6;
}

test("vertices lie on the rays of the colour pixels that their depth belongs to", () => {
  const grid = makeDepthGrid(input(20, 10, () => 50));
  assert.equal(grid.positions.length, 3 * 200);
  assert.equal(cells(grid), 19 * 9);
  const focal = 10 / Math.tan(Math.PI / 6);
  // Depth pixel (3, 2): colour pixel (6, 4), whose middle is at 6.5, 4.5.
  const at = 2 * 20 + 3;
  assert.ok(Math.abs((grid.positions[3 * at] ?? 0) - (50 * (6.5 - 20)) / focal) < 1e-4);
  assert.ok(Math.abs((grid.positions[3 * at + 1] ?? 0) - (50 * (4.5 - 10)) / focal) < 1e-4);
  assert.equal(grid.positions[3 * at + 2], 50);
  assert.ok(
    Math.abs((grid.uvs[2 * at] ?? 0) - 6.5 / 40) < 1e-6 && Math.abs((grid.uvs[2 * at + 1] ?? 0) - 4.5 / 20) < 1e-6,
  );
});

test("orthographic vertices do not spread with depth", () => {
  const grid = makeDepthGrid(input(20, 10, (i) => 50 + i * 0.1, 40));
  assert.ok(Math.abs((grid.positions[0] ?? 0) - (0.5 - 20) * 2) < 1e-4);
  assert.ok(Math.abs((grid.positions[3 * 19] ?? 0) - (38.5 - 20) * 2) < 1e-4);
});

test("it is cut where the depth jumps, and only there", () => {
  const whole = makeDepthGrid(input(40, 30, (i) => 100 + i));
  assert.equal(cells(whole), 39 * 29);
  // A wall of 80 m beside the ground, seen from above: one column of cells is missing.
  const cut = makeDepthGrid(input(40, 30, (i) => (i < 20 ? 20 : 100)));
  assert.equal(cells(cut), 38 * 29);
});

test("without a surface there are holes, and no vertex is NaN", () => {
  const grid = makeDepthGrid(input(10, 10, (i, j) => (i === 4 && j === 5 ? Number.NaN : 30)));
  // Four cells touch the hole; half of two of them stay.
  assert.ok(cells(grid) >= 9 * 9 - 4 && cells(grid) <= 9 * 9 - 3);
  assert.ok(grid.positions.every(Number.isFinite));
  assert.ok(!grid.indices.includes(5 * 10 + 4));
});

test("large frames become coarser grids that reach the last row and column", () => {
  const grid = makeDepthGrid(
    input(500, 281, () => 80),
    10_000,
  );
  assert.ok(grid.positions.length / 3 <= 10_500, `${grid.positions.length / 3}`);
  const last = grid.uvs.length - 2;
  assert.ok(
    Math.abs((grid.uvs[last] ?? 0) - 998.5 / 1000) < 1e-5 && Math.abs((grid.uvs[last + 1] ?? 0) - 560.5 / 562) < 1e-5,
  );
});

test("frames without depth make an empty grid", () => {
  for (const wrong of [
    input(0, 0, () => 1),
    input(1, 1, () => 1),
    { ...input(10, 10, () => 1), depthM: new Float32Array(3) },
  ]) {
    assert.equal(makeDepthGrid(wrong).indices.length, 0);
  }
});
