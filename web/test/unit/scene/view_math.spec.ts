import assert from "node:assert/strict";
import { test } from "node:test";
import { Vector3 } from "three";
import type { Vec2, Vec3 } from "../../../src/base/vec.js";
import { add, cross, norm, scale, sub } from "../../../src/base/vec_math.js";
import { CameraRig } from "../../../src/scene/camera_rig.js";
import { cameraFromEnu, cornersOf, depthRange, pixelSizeM, projectPoint, rayAt } from "../../../src/scene/view_math.js";
import { exactSize } from "../../../src/scene/view_size.js";
import { makeWorld, sceneFromEnu } from "../../../src/scene/world.js";
import { lookingAt, sampleBase } from "./samples.js";

const SIZE: Vec2 = [400, 250];
const POSES = [
  lookingAt([40, -200, 150], [0, 10, 3]),
  lookingAt([20, 30, 90], [20, 30, 0], 120),
  lookingAt([-5, 8, 60], [-5, 8, 0]),
];

test("a ray at a pixel leads through the points that are projected there", () => {
  for (const pose of POSES) {
    for (const px of [
      [0, 0],
      [200, 125],
      [399, 3],
      [17, 240],
    ] as const) {
      const ray = rayAt(pose, SIZE, px);
      assert.ok(Math.abs(norm(ray.direction) - 1) < 1e-12);
      const back = projectPoint(pose, SIZE, add(ray.originEnu, scale(ray.direction, 123)));
      assert.ok(back !== null && Math.hypot(back[0] - px[0], back[1] - px[1]) < 1e-9);
    }
  }
});

test("the three.js camera shows a point where we project it", () => {
  const world = makeWorld(sampleBase());
  for (const pose of POSES) {
    const rig = new CameraRig(world, pose);
    rig.resize(SIZE);
    const camera = rig.update(world.boxEnu);
    for (const point of [
      [10, 20, 3],
      [-60, 5, 20],
      [33, -40, 0],
    ] as const) {
      const clip = new Vector3(...sceneFromEnu(world, point)).project(camera);
      const px = rig.project(point);
      assert.ok(px !== null);
      assert.ok(Math.abs((clip.x * 0.5 + 0.5) * SIZE[0] - px[0]) < 1e-6, `${clip.x} ${px[0]}`);
      assert.ok(Math.abs((0.5 - clip.y * 0.5) * SIZE[1] - px[1]) < 1e-6);
    }
  }
});

test("what is behind the camera has no place on the canvas", () => {
  assert.equal(projectPoint(lookingAt([0, 0, 50], [0, 100, 0]), SIZE, [0, -100, 100]), null);
});

test("near and far hold the box, from outside, inside and above", () => {
  const box = { min: [-100, -100, 0] as Vec3, max: [100, 100, 30] as Vec3 };
  for (const pose of [...POSES, lookingAt([0, 0, 5], [50, 0, 5]), lookingAt([0, 0, 500], [0, 300, 900])]) {
    const { near, far } = depthRange(pose, box);
    assert.ok(far > near && Number.isFinite(far), `${near} ${far}`);
    if (pose.orthoHeightM === null) assert.ok(near > 0);
    for (const corner of cornersOf(box)) {
      const z = cameraFromEnu(pose, corner)[2];
      assert.ok(z < far && (z > near || z < 2), `${z} in ${near} ${far}`);
    }
  }
});

test("the size of a pixel is the distance between neighbouring rays", () => {
  for (const pose of POSES) {
    const [a, b] = [rayAt(pose, SIZE, [200, 125]), rayAt(pose, SIZE, [200, 126])];
    const depth = 70;
    const at = (ray: typeof a) => add(ray.originEnu, scale(ray.direction, depth));
    assert.ok(Math.abs(norm(sub(at(a), at(b))) / pixelSizeM(pose, SIZE, depth) - 1) < 1e-4);
    assert.ok(norm(cross(a.direction, b.direction)) <= a.pixelPitch + 1e-12);
  }
});

test("poses that are no numbers are ignored, equal ones change nothing", () => {
  const rig = new CameraRig(makeWorld(sampleBase()), POSES[0] ?? lookingAt([0, 0, 1], [0, 0, 0]));
  const { version, pose } = rig;
  rig.set({ ...pose, eyeEnu: [Number.NaN, 0, 0] });
  rig.set({ ...pose, orthoHeightM: 0 });
  rig.set({ ...pose });
  assert.equal(rig.version, version);
  assert.equal(rig.pose, pose);
  rig.set({ ...pose, fovyDeg: 30 });
  assert.ok(rig.version > version);
});

test("exact frames have the canvas's pixels, up to what the engine can do in a few seconds", () => {
  assert.deepEqual(exactSize(400, 250), [400, 250]);
  assert.deepEqual(exactSize(1000, 563), [1000, 563]);
  for (const [w, h] of [
    [1920, 1080],
    [3840, 1000],
    [600, 3000],
    [5000, 30],
  ] as const) {
    const [x, y] = exactSize(w, h);
    assert.ok(x * y <= 1.02 * 1000 * 563 && Math.max(x, y) <= 1600, `${x} ${y}`);
    if (y > 16) assert.ok(Math.abs(x / y / (w / h) - 1) < 0.05);
  }
  assert.deepEqual(exactSize(0, 0), [16, 16]);
  assert.deepEqual(exactSize(Number.NaN, 100), [16, 100]);
});
