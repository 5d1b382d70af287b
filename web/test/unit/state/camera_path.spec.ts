import assert from "node:assert/strict";
import test from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { angleBetweenRad, norm, sub } from "../../../src/base/vec_math.js";
import { forward, rotationFromAngles } from "../../../src/geo/camera.js";
import type { CameraPose, KeyFrame } from "../../../src/state/app_state.js";
import {
  fovAcrossDeg,
  fovyOfAcrossDeg,
  framesBetween,
  keyPose,
  movedKey,
  pathLengthM,
  pathSeconds,
  perspectivePose,
  poseOnPath,
  VIDEO_ASPECT,
} from "../../../src/state/camera_path.js";

function key(eyeEnu: Vec3, yawDeg = 0, fovyDeg = 40): KeyFrame {
  return {
    name: `${eyeEnu}`,
    pose: { eyeEnu, rotation: rotationFromAngles({ yawDeg, pitchDeg: -30, rollDeg: 0 }), fovyDeg, orthoHeightM: null },
  };
}

const KEYS = [key([0, 0, 10], 0), key([10, 0, 10], 90, 60), key([10, 20, 30], 350)];

test("the path goes through its keys, as the video does", () => {
  KEYS.forEach(({ pose }, i) => {
    const there = poseOnPath(KEYS, i);
    assert.ok(there !== null && norm(sub(there.eyeEnu, pose.eyeEnu)) < 1e-12);
    assert.ok(angleBetweenRad(there.rotation, pose.rotation) < 1e-9 && Math.abs(there.fovyDeg - pose.fovyDeg) < 1e-9);
  });
  // Interpolate of products/camera_path_file.cpp by hand: 0.5 (2 b + u (c - a) + u^2 (2a - 5b + 4c - d) + u^3 (3b - 3c + d - a)) with a = b = key 0,
  // c = key 1, d = key 2, u = 1/2.
  const middle = poseOnPath(KEYS, 0.5);
  assert.ok(middle !== null && norm(sub(middle.eyeEnu, [5, -1.25, 8.75])) < 1e-12, String(middle?.eyeEnu));
  const fov = (fovAcrossDeg(40, VIDEO_ASPECT) + fovAcrossDeg(60, VIDEO_ASPECT)) / 2;
  assert.ok(Math.abs(fovAcrossDeg(middle.fovyDeg, VIDEO_ASPECT) - fov) < 1e-9);
  // 45 degrees clockwise from north, the horizon level at the ends.
  assert.ok(
    Math.abs(
      angleBetweenRad(middle.rotation, KEYS[0]?.pose.rotation ?? [1, 0, 0, 0]) -
        angleBetweenRad(middle.rotation, KEYS[1]?.pose.rotation ?? [1, 0, 0, 0]),
    ) < 1e-9,
  );
});

test("outside the path its ends, without keys nothing", () => {
  assert.equal(poseOnPath([], 0), null);
  assert.deepEqual(poseOnPath(KEYS, -3)?.eyeEnu, [0, 0, 10]);
  assert.deepEqual(poseOnPath(KEYS, 99)?.eyeEnu, [10, 20, 30]);
  assert.deepEqual(poseOnPath(KEYS, Number.NaN)?.eyeEnu, [0, 0, 10]);
  assert.deepEqual(poseOnPath(KEYS.slice(0, 1), 0.5)?.eyeEnu, [0, 0, 10]);
});

test("length, time and frames follow the speed", () => {
  const straight = [key([0, 0, 0]), key([100, 0, 0]), key([200, 0, 0])];
  assert.ok(Math.abs(pathLengthM(straight) - 200) < 1e-6);
  assert.ok(Math.abs(pathSeconds({ keys: straight, speedMps: 10 }) - 20) < 1e-6);
  // 10 s per section are 120 frames, of which one is the key itself.
  assert.equal(framesBetween({ keys: straight, speedMps: 10 }), 119);
  assert.equal(framesBetween({ keys: straight, speedMps: 1e-9 }), 10000);
  assert.equal(pathSeconds({ keys: straight.slice(0, 1), speedMps: 10 }), 0);
  assert.equal(framesBetween({ keys: [], speedMps: 10 }), 0);
  assert.ok(Number.isFinite(pathSeconds({ keys: straight, speedMps: Number.NaN })));
  // Turning in place by 90 degrees, 30 degrees a second.
  const turning = [key([0, 0, 0], 0), key([0, 0, 0], 0.01)].map((one, i) => ({
    ...one,
    pose: { ...one.pose, rotation: rotationFromAngles({ yawDeg: 90 * i, pitchDeg: 0, rollDeg: 0 }) },
  }));
  assert.ok(Math.abs(pathSeconds({ keys: turning, speedMps: 10 }) - 3) < 1e-6);
});

test("fields of view across and down are inverse", () => {
  assert.ok(Math.abs(fovAcrossDeg(90, 2) - 2 * 63.43494882292201) < 1e-9);
  for (const fov of [1, 40, 120]) assert.ok(Math.abs(fovyOfAcrossDeg(fovAcrossDeg(fov, 16 / 9), 16 / 9) - fov) < 1e-9);
});

test("an orthographic view becomes the perspective one that shows as much of the ground", () => {
  const rotation = rotationFromAngles({ yawDeg: 20, pitchDeg: -90, rollDeg: 0 });
  const pose: CameraPose = { eyeEnu: [5, 6, 500], rotation, fovyDeg: 50, orthoHeightM: 80 };
  const seen = perspectivePose(pose, 490);
  const away = 40 / Math.tan((25 * Math.PI) / 180);
  assert.equal(seen.orthoHeightM, null);
  assert.ok(norm(sub(seen.eyeEnu, [5, 6, 10 + away])) < 1e-9);
  assert.ok(norm(sub(forward(seen.rotation), [0, 0, -1])) < 1e-9);
  assert.deepEqual(perspectivePose(seen, 3), seen);
  const scene = { canvas: { clientWidth: 200, clientHeight: 100 }, pose: () => pose };
  const picked = keyPose({ ...scene, pickSurface: ([x, y]) => (x === 100 && y === 50 ? { enu: [5, 6, 10] } : null) });
  assert.ok(norm(sub(picked.eyeEnu, seen.eyeEnu)) < 1e-9);
  assert.ok(keyPose({ ...scene, pickSurface: () => null }).eyeEnu.every(Number.isFinite));
});

test("keys are moved, never lost", () => {
  const names = (keys: readonly KeyFrame[]) => keys.map(({ name }) => KEYS.findIndex((one) => one.name === name));
  assert.deepEqual(names(movedKey(KEYS, 0, 2)), [1, 2, 0]);
  assert.deepEqual(names(movedKey(KEYS, 2, 0)), [2, 0, 1]);
  for (const [from, to] of [
    [0, -1],
    [2, 3],
    [5, 0],
    [1, 1],
  ] as const)
    assert.equal(movedKey(KEYS, from, to), KEYS);
});
