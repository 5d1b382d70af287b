// The same ways as the program plans for its videos: tests/tour/ways/route_test.cpp reads the same table.
import assert from "node:assert/strict";
import test from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { angleBetweenRad, norm, sub } from "../../../src/base/vec_math.js";
import { Heights } from "../../../src/tour/heights.js";
import { planRoute, poseAt } from "../../../src/tour/route.js";
import type { Path, TourPose } from "../../../src/tour/types.js";
import table from "./route_cases.json";

function vec3(list: readonly number[]): Vec3 {
  return [list[0] ?? Number.NaN, list[1] ?? Number.NaN, list[2] ?? Number.NaN];
}

function poseFrom({ eye, rotation, fovyDeg }: { eye: number[]; rotation: number[]; fovyDeg: number }): TourPose {
  const [w, x, y, z] = rotation;
  return { eyeEnu: vec3(eye), rotation: [w ?? 0, x ?? 0, y ?? 0, z ?? 0], fovyDeg };
}

function pathFrom({ kind, about }: { kind: string; about: number[] | null }): Path {
  if (kind === "orbit") return { kind, about: vec3(about ?? []) };
  return { kind: kind === "over" ? "over" : "direct" };
}

const { minX, minY, cellX, cellY, columns, rows, z } = table.heights;
const heights = new Heights({
  min: [minX, minY],
  cellM: [cellX, cellY],
  columns,
  rows,
  z: Float64Array.from(z, (top) => top ?? Number.NaN),
});

for (const { name, from, to, path, solid, lengthM, durationS, poses } of table.cases) {
  test(`the way "${name}" is that of the table`, () => {
    const route = planRoute(poseFrom(from), poseFrom(to), pathFrom(path), solid ? heights : null);
    assert.ok(Math.abs(route.lengthM - lengthM) < 1e-6, `${route.lengthM} m`);
    assert.ok(Math.abs(route.durationS - durationS) < 1e-6, `${route.durationS} s`);
    assert.ok(poses.length >= 9);
    poses.forEach((expected, i) => {
      const pose = poseAt(route, (durationS * (i + 1)) / (poses.length + 1));
      const there = poseFrom(expected);
      assert.ok(norm(sub(pose.eyeEnu, there.eyeEnu)) < 1e-6, `${i}: ${pose.eyeEnu}`);
      assert.ok(angleBetweenRad(pose.rotation, there.rotation) < 1e-6, `${i}: ${pose.rotation}`);
      assert.ok(Math.abs(pose.fovyDeg - there.fovyDeg) < 1e-6, `${i}: ${pose.fovyDeg}`);
    });
  });
}
