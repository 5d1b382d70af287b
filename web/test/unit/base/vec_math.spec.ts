import assert from "node:assert/strict";
import test from "node:test";
import type { Quat, Vec3 } from "../../../src/base/vec.js";
import {
  angleBetweenRad,
  cross,
  matrixFromQuat,
  norm,
  normalize,
  quatConjugate,
  quatFromMatrix,
  quatMultiply,
  quatNormalize,
  quatRotate,
  slerp,
  sub,
  transformPoint,
} from "../../../src/base/vec_math.js";

function near(a: readonly number[], b: readonly number[]): void {
  assert.equal(a.length, b.length);
  a.forEach((value, i) => {
    assert.ok(Math.abs(value - (b[i] ?? Number.NaN)) < 1e-12, `${a} instead of ${b}`);
  });
}

const QUARTER_ABOUT_Z: Quat = [Math.SQRT1_2, 0, 0, Math.SQRT1_2];
const SOME: readonly Quat[] = [
  [1, 0, 0, 0],
  [0, 1, 0, 0],
  [0, 0, 1, 0],
  [0, 0, 0, 1],
  QUARTER_ABOUT_Z,
  quatNormalize([0.1, -0.9, 0.3, 0.2]),
  quatNormalize([-0.01, 0.2, 0.9, -0.4]),
  quatNormalize([0.02, 0.2, -0.3, 0.9]),
  quatNormalize([0.9, 0.2, -0.3, 0.1]),
];

test("a quarter about z turns x to y", () => {
  near(quatRotate(QUARTER_ABOUT_Z, [1, 0, 0]), [0, 1, 0]);
  near(quatRotate(QUARTER_ABOUT_Z, [0, 1, 0]), [-1, 0, 0]);
  near(cross([1, 0, 0], [0, 1, 0]), [0, 0, 1]);
});

test("quaternions and their matrices say the same", () => {
  const v: Vec3 = [0.3, -2, 5];
  for (const q of SOME) {
    const m = matrixFromQuat(q);
    const [a = 0, b = 0, c = 0, d = 0, e = 0, f = 0, g = 0, h = 0, i = 0] = m;
    near(transformPoint([a, b, c, 0, d, e, f, 0, g, h, i, 0, 0, 0, 0, 1], v), quatRotate(q, v));
    const back = quatFromMatrix(m);
    assert.ok(back[0] >= 0);
    assert.ok(angleBetweenRad(back, q) < 1e-12, `${back} instead of ${q}`);
    near(quatRotate(quatConjugate(q), quatRotate(q, v)), v);
    for (const p of SOME) near(quatRotate(quatMultiply(p, q), v), quatRotate(p, quatRotate(q, v)));
  }
});

test("slerp goes the short way at constant speed", () => {
  for (const a of SOME) {
    for (const b of SOME) {
      const whole = angleBetweenRad(a, b);
      for (const u of [0, 0.25, 0.5, 1]) {
        const q = slerp(a, b, u);
        assert.ok(Math.abs(Math.hypot(...q) - 1) < 1e-12);
        if (whole < 3.14) assert.ok(Math.abs(angleBetweenRad(a, q) - u * whole) < 1e-7);
      }
      const minus: Quat = [-b[0], -b[1], -b[2], -b[3]];
      if (whole < 3.14) assert.ok(angleBetweenRad(slerp(a, minus, 0.5), slerp(a, b, 0.5)) < 1e-12);
    }
  }
  assert.ok(slerp([1, 0, 0, 0], quatNormalize([1, 1e-10, 0, 0]), 0.3).every(Number.isFinite));
});

test("zero has no direction and no NaN", () => {
  near(normalize([0, 0, 0]), [0, 0, 0]);
  near(normalize([0, 3, 4]), [0, 0.6, 0.8]);
  near(quatNormalize([0, 0, 0, 0]), [1, 0, 0, 0]);
  assert.equal(norm(sub([1, 2, 3], [1, 2, 3])), 0);
});
