// Where things stand, and which of them have changed.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { dot, norm, sub, transformPoint } from "../../../src/base/vec_math.js";
import { forward, right, rotationFromAngles } from "../../../src/geo/camera.js";
import { byId, changesBetween } from "../../../src/scene/thing_changes.js";
import { boxThrough, enuFromModel, sceneFromModel } from "../../../src/scene/thing_transform.js";
import { makeWorld } from "../../../src/scene/world.js";
import { sampleProject } from "./samples.js";

const AT: Vec3 = [123_456.789, -98_765.4321, 512.25];

test("a model's x is to the right of where its yaw points, its -z ahead, its y up, by its scale", () => {
  for (const yawDeg of [-360, -45, 0, 12.34, 90, 180, 271.5, 360]) {
    for (const scale of [1e-4, 1, 3.7, 1e4]) {
      const matrix = enuFromModel({ at: AT, yawDeg, scale });
      // Heading as that of cameras, which other tests hold against the program.
      const rotation = rotationFromAngles({ yawDeg, pitchDeg: 0, rollDeg: 0 });
      const [ahead, aside] = [forward(rotation), right(rotation)];
      const p: Vec3 = [1.5, 2.5, -3.5];
      const d = sub(transformPoint(matrix, p), AT);
      // The place itself takes digits of its own.
      const tolerance = 1e-9 * Math.max(1, scale) + 2e-10;
      assert.ok(Math.abs(dot(d, aside) - scale * p[0]) < tolerance);
      assert.ok(Math.abs(dot(d, ahead) + scale * p[2]) < tolerance);
      assert.ok(Math.abs(d[2] - scale * p[1]) < tolerance);
    }
  }
});

test("clockwise from north: at 90 degrees what was north is east", () => {
  const matrix = enuFromModel({ at: [0, 0, 0], yawDeg: 90, scale: 2 });
  assert.ok(norm(sub(transformPoint(matrix, [0, 0, -1]), [2, 0, 0])) < 1e-9);
  assert.ok(norm(sub(transformPoint(matrix, [1, 0, 0]), [0, -2, 0])) < 1e-9);
});

test("in the scene the anchor is subtracted", () => {
  const world = makeWorld(sampleProject({ min: [0, 0, 0], max: [100, 60, 20], groundM: 3 }));
  const thing = { at: [50, 30, 7] as const, yawDeg: 33, scale: 1 };
  const p: Vec3 = [4, 5, 6];
  const moved = sub(transformPoint(enuFromModel(thing), p), world.anchor);
  assert.ok(norm(sub(transformPoint(sceneFromModel(world, thing), p), moved)) < 1e-9);
});

test("the box of a turned model holds its corners and no more", () => {
  const matrix = enuFromModel({ at: [10, 20, 30], yawDeg: 45, scale: 1 });
  const box = boxThrough(matrix, { min: [-1, 0, -1], max: [1, 4, 1] });
  const half = Math.SQRT2;
  assert.ok(norm(sub(box.min, [10 - half, 20 - half, 30])) < 1e-9);
  assert.ok(norm(sub(box.max, [10 + half, 20 + half, 34])) < 1e-9);
});

test("only other objects have changed; the first of an id counts", () => {
  const [a, b, c] = [{ id: "a" }, { id: "b" }, { id: "c" }];
  const newB = { id: "b" };
  const changes = changesBetween(byId([a, b, { id: "a" }]), byId([newB, c, a]));
  assert.deepEqual(changes.added, [c]);
  assert.deepEqual(changes.removed, []);
  assert.equal(changes.changed.length, 1);
  assert.equal(changes.changed[0]?.before, b);
  assert.equal(changes.changed[0]?.after, newB);
  assert.deepEqual(changesBetween(byId([a, b]), byId([b])).removed, [a]);
});
