import assert from "node:assert/strict";
import { test } from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { dot, sub } from "../../../src/base/vec_math.js";
import { boxHolds, clipInScene, halfSpacesOf, swipeColumns } from "../../../src/scene/clip.js";
import { makeWorld } from "../../../src/scene/world.js";
import { sampleBase } from "./samples.js";

test("the six planes keep exactly what the box holds", () => {
  const world = makeWorld(sampleBase());
  // Corners in the wrong order are put right.
  const box = clipInScene(world, { on: true, min: [10, -5, 2], max: [-20, 30, 12] });
  assert.ok(box !== null);
  const planes = halfSpacesOf(box);
  const places: Vec3[] = [
    [0, 0, 5],
    [-19.9, 29.9, 11.9],
    [-20.1, 0, 5],
    [10.1, 0, 5],
    [0, -5.1, 5],
    [0, 30.1, 5],
    [0, 0, 1.9],
    [0, 0, 12.1],
  ];
  for (const [i, enu] of places.entries()) {
    const p = sub(enu, world.anchor);
    const kept = planes.every(({ normal, constant }) => dot(normal, p) + constant >= 0);
    assert.equal(kept, i < 2, `${enu}`);
    assert.equal(boxHolds(box, p), i < 2);
  }
});

test("a box that is off or no numbers clips nothing", () => {
  const world = makeWorld(sampleBase());
  assert.equal(clipInScene(world, { on: false, min: [0, 0, 0], max: [1, 1, 1] }), null);
  assert.equal(clipInScene(world, { on: true, min: [Number.NaN, 0, 0], max: [1, 1, 1] }), null);
});

test("both sides of the swipe are the whole canvas", () => {
  for (const at of [-1, 0, 0.123, 0.5, 0.999, 1, 2, Number.NaN]) {
    const { before, main } = swipeColumns(at, 397);
    assert.equal(before.x, 0);
    assert.equal(before.w, main.x);
    assert.equal(main.x + main.w, 397);
    assert.ok(before.w >= 0 && main.w >= 0 && Number.isInteger(before.w));
  }
  assert.equal(swipeColumns(0.25, 400).before.w, 100);
});
