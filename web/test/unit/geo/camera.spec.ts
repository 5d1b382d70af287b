import assert from "node:assert/strict";
import test from "node:test";
import type { Quat, Vec3 } from "../../../src/base/vec.js";
import { angleBetweenRad, norm, quatRotate, sub } from "../../../src/base/vec_math.js";
import {
  anglesOfPose,
  forward,
  interpolatePose,
  northUp,
  poseLookingAt,
  right,
  rotationFromAngles,
  rotationFromThree,
  threeQuaternion,
  up,
} from "../../../src/geo/camera.js";
import { ANGLES, LOOKING_AT } from "./reference.js";

function near(a: Vec3, b: Vec3, what = ""): void {
  assert.ok(norm(sub(a, b)) < 1e-12, `${what} ${a} instead of ${b}`);
}

test("rotations of angles as products/camera_path.cpp, and the angles again", () => {
  for (const { angles, rotation } of ANGLES) {
    const [yawDeg, pitchDeg, rollDeg] = angles;
    const found = rotationFromAngles({ yawDeg, pitchDeg, rollDeg });
    assert.ok(angleBetweenRad(found, rotation) < 1e-12, `${angles}: ${found}`);
    const back = anglesOfPose(rotation);
    const off = [back.yawDeg - yawDeg, back.pitchDeg - pitchDeg, back.rollDeg - rollDeg];
    assert.ok(
      off.every((value) => Math.abs(((value + 540) % 360) - 180) < 1e-9),
      `${angles}: ${JSON.stringify(back)}`,
    );
  }
});

test("every rotation has angles that give it again", () => {
  for (let i = 0; i < 500; i += 1) {
    const part = (k: number) => Math.sin(12.9898 * i + 78.233 * k);
    const length = Math.hypot(part(1), part(2), part(3), part(4));
    const q: Quat = [part(1) / length, part(2) / length, part(3) / length, part(4) / length];
    const angles = anglesOfPose(q);
    assert.ok(angles.yawDeg >= 0 && angles.yawDeg < 360 && Math.abs(angles.pitchDeg) <= 90);
    assert.ok(angleBetweenRad(rotationFromAngles(angles), q) < 1e-9);
  }
});

test("views of a target as products/camera_path.cpp", () => {
  for (const { eye, target, rotation } of LOOKING_AT) {
    assert.ok(angleBetweenRad(poseLookingAt(eye, target), rotation) < 1e-12, `${eye} to ${target}`);
  }
  assert.ok(poseLookingAt([1, 2, 3], [1, 2, 3]).every(Number.isFinite));
});

test("straight down, north is up and east is right", () => {
  const q = poseLookingAt([3, 4, 100], [3, 4, 0]);
  near(forward(q), [0, 0, -1]);
  near(up(q), [0, 1, 0]);
  near(right(q), [1, 0, 0]);
});

test("a three.js camera with this quaternion looks the same way", () => {
  for (const { rotation } of [...ANGLES, ...LOOKING_AT]) {
    const [x, y, z, w] = threeQuaternion(rotation);
    // three.js: world = q * local, looking along -z with y up.
    near(quatRotate([w, x, y, z], [0, 0, -1]), forward(rotation), "forward");
    near(quatRotate([w, x, y, z], [0, 1, 0]), up(rotation), "up");
    near(quatRotate([w, x, y, z], [1, 0, 0]), right(rotation), "right");
    assert.ok(angleBetweenRad(rotationFromThree(x, y, z, w), rotation) < 1e-12);
  }
});

test("poses between two poses", () => {
  const a = {
    eyeEnu: [0, 0, 10] as Vec3,
    rotation: rotationFromAngles({ yawDeg: 350, pitchDeg: 0, rollDeg: 0 }),
    fovyDeg: 40,
    orthoHeightM: null,
  };
  const b = {
    ...a,
    eyeEnu: [4, 8, 30] as Vec3,
    rotation: rotationFromAngles({ yawDeg: 30, pitchDeg: 0, rollDeg: 0 }),
    fovyDeg: 60,
  };
  const half = interpolatePose(a, b, 0.5);
  near(half.eyeEnu, [2, 4, 20]);
  assert.equal(half.fovyDeg, 50);
  assert.ok(Math.abs(anglesOfPose(half.rotation).yawDeg - 10) < 1e-9, "the short way, across north");
  assert.deepEqual(interpolatePose(a, b, 1).eyeEnu, b.eyeEnu);
  assert.equal(interpolatePose(a, { ...b, orthoHeightM: 50 }, 0.4).orthoHeightM, null);
  assert.equal(interpolatePose(a, { ...b, orthoHeightM: 50 }, 0.6).orthoHeightM, 50);
  const heights = interpolatePose({ ...a, orthoHeightM: 10 }, { ...b, orthoHeightM: 1000 }, 0.5).orthoHeightM;
  assert.ok(heights !== null && Math.abs(heights - 100) < 1e-9);
});

test("north up turns about the place that is looked at and keeps tilt and distance", () => {
  const rotation = rotationFromAngles({ yawDeg: 125, pitchDeg: -40, rollDeg: 0 });
  const ahead = forward(rotation);
  const target = [30, -7, 2] as const;
  const eye = [target[0] - 50 * ahead[0], target[1] - 50 * ahead[1], target[2] - 50 * ahead[2]] as const;
  const turned = northUp({ eyeEnu: eye, rotation, fovyDeg: 50, orthoHeightM: null }, target);
  const { yawDeg, pitchDeg } = anglesOfPose(turned.rotation);
  assert.ok(Math.min(yawDeg, 360 - yawDeg) < 1e-9 && Math.abs(pitchDeg + 40) < 1e-9);
  const now = forward(turned.rotation);
  for (const axis of [0, 1, 2] as const) {
    assert.ok(Math.abs(turned.eyeEnu[axis] + 50 * now[axis] - target[axis]) < 1e-9);
  }
  assert.deepEqual(northUp({ eyeEnu: eye, rotation, fovyDeg: 50, orthoHeightM: null }, null).eyeEnu, eye);
});
