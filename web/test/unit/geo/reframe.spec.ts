import assert from "node:assert/strict";
import test from "node:test";
import { fills, reframedDepth, reframing } from "../../../src/geo/reframe.js";

const STILL = { width: 160, height: 90, fovyDeg: 50 };

test("the same view is the still itself", () => {
  assert.deepEqual(reframing(STILL, STILL), { left: 0, top: 0, scale: 1 });
  assert.ok(fills(STILL, STILL));
});

test("the middle stays the middle, and a direction keeps its place", () => {
  for (const view of [
    { width: 400, height: 250, fovyDeg: 50 },
    { width: 30, height: 90, fovyDeg: 50 },
    { width: 77, height: 33, fovyDeg: 20 },
    { width: 300, height: 100, fovyDeg: 80 },
  ]) {
    const { left, top, scale } = reframing(STILL, view);
    const tangent = (x: number, frame: typeof view) =>
      ((x - frame.width / 2) / (frame.height / 2)) * Math.tan((frame.fovyDeg * Math.PI) / 360);
    for (const x of [0, 10, view.width / 2, view.width]) {
      assert.ok(Math.abs(tangent(left + scale * x, STILL) - tangent(x, view)) < 1e-12);
    }
    assert.ok(Math.abs(top + (scale * view.height) / 2 - STILL.height / 2) < 1e-9);
  }
});

test("a still fills what sees less than it", () => {
  assert.ok(fills(STILL, { width: 400, height: 250, fovyDeg: 50 }));
  assert.ok(fills(STILL, { width: 320, height: 180, fovyDeg: 20 }));
  assert.ok(!fills(STILL, { width: 200, height: 90, fovyDeg: 50 }));
  assert.ok(!fills(STILL, { width: 16, height: 9, fovyDeg: 51 }));
});

test("depth comes from the nearest value, and beyond the rim there is none", () => {
  const depth = { width: 80, height: 45, depthM: Float32Array.from({ length: 80 * 45 }, (_, i) => 1 + i) };
  assert.deepEqual(reframedDepth(STILL, depth, STILL), depth);
  const wide = { width: 200, height: 90, fovyDeg: 50 };
  const found = reframedDepth(STILL, depth, wide);
  assert.deepEqual([found.width, found.height], [100, 45]);
  for (let i = 0; i < 100; i += 1) {
    const column = i - 10;
    const z = found.depthM[3 * 100 + i] ?? 0;
    if (column < 0 || column >= 80) assert.ok(Number.isNaN(z), `${i}: ${z}`);
    else assert.equal(z, 1 + 3 * 80 + column);
  }
  // Half as many pixels: every second value, or its neighbour.
  const small = reframedDepth(STILL, depth, { width: 80, height: 45, fovyDeg: 50 });
  assert.deepEqual([small.width, small.height], [40, 23]);
  small.depthM.forEach((z, at) => {
    const column = (z - 1) % 80;
    assert.ok(Math.abs(column - 2 * (at % 40)) <= 1, `${column} at ${at % 40}`);
  });
});
