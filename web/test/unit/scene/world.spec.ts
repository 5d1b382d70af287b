import assert from "node:assert/strict";
import { test } from "node:test";
import { Matrix4, Quaternion, Vector3 } from "three";
import type { Vec3 } from "../../../src/base/vec.js";
import { sub, transformPoint } from "../../../src/base/vec_math.js";
import { ecefFromEnuMatrix } from "../../../src/geo/earth.js";
import { matrixOf } from "../../../src/scene/surface_style.js";
import {
  makeWorld,
  multiply,
  sceneFromEnu,
  sceneFromOwnEnu,
  sceneFromTiles,
  translation,
} from "../../../src/scene/world.js";
import { sampleBase } from "./samples.js";

// The root transform that the C++ side wrote for a tileset at this origin, column by column.
const ROOT = [
  -0.14852917993721917, 0.9889080254033623, 0, 0, -0.7276623879385629, -0.10929135468143195, 0.6771726877033996, 0,
  0.6696615054538566, 0.10057990398046857, 0.7358241305016805, 0, 4279227.806485564, 642719.2221466678,
  4670540.878540811, 1,
];
const CORNERS: readonly Vec3[] = [
  [-157.367501, -135.652542, -2.554066],
  [161.424786, 134.251247, 30.66334],
  [0, 0, 0],
];

function distance(a: Vec3, b: Vec3): number {
  return Math.hypot(...sub(a, b));
}

test("a tile's corners lie within 1 mm of their place in ENU, through ECEF", () => {
  const world = makeWorld(sampleBase());
  const root = new Matrix4().fromArray(ROOT);
  const toScene = matrixOf(sceneFromTiles(world, sampleBase()));
  const [position, rotation, scale] = [new Vector3(), new Quaternion(), new Vector3()];
  for (const corner of CORNERS) {
    // As the library does: the tile's middle and its up-axis are combined with the root's transform and taken apart again.
    const middle: Vec3 = [80.62806019629167, 66.98303614208209, 14.075439355561551];
    const tile = new Matrix4().multiplyMatrices(root, new Matrix4().makeTranslation(...middle));
    tile.multiply(new Matrix4().makeRotationX(Math.PI / 2)).decompose(position, rotation, scale);
    const object = new Matrix4().compose(position, rotation, scale);
    const local = sub(corner, middle);
    const p = new Vector3(local[0], local[2], -local[1]).applyMatrix4(new Matrix4().multiplyMatrices(toScene, object));
    assert.ok(distance([p.x, p.y, p.z], sceneFromEnu(world, corner)) < 1e-3, `${p.x} ${p.y} ${p.z}`);
  }
});

test("without geo-reference tiles are in the local frame", () => {
  const project = sampleBase({ georeferenced: false });
  const world = makeWorld(project);
  for (const corner of CORNERS) {
    assert.ok(distance(transformPoint(sceneFromTiles(world, project), corner), sceneFromEnu(world, corner)) < 1e-12);
  }
});

test("the earlier project comes through its own origin and its place in ours", () => {
  const world = makeWorld(sampleBase());
  const before = sampleBase({ origin: { latitudeDeg: 47.378, longitudeDeg: 8.54, heightM: 420 } });
  const enuFromBefore = multiply(translation([-128, 122, 12]), [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  const own: Vec3 = [30, -20, 5];
  const wanted = sub(transformPoint(enuFromBefore, own), world.anchor);
  assert.ok(distance(transformPoint(sceneFromOwnEnu(world, enuFromBefore), own), wanted) < 1e-9);
  const ecef = transformPoint(ecefFromEnuMatrix(before.origin), own);
  assert.ok(distance(transformPoint(sceneFromTiles(world, before, enuFromBefore), ecef), wanted) < 1e-6);
});

test("a box without size or with wrong numbers becomes one that can be looked at", () => {
  for (const bad of [
    sampleBase({ min: [5, 5, 5], max: [5, 5, 5] }),
    sampleBase({ min: [Number.NaN, 0, 0], max: [Number.NaN, 0, 0], groundM: Number.NaN }),
  ]) {
    const world = makeWorld(bad);
    assert.ok(world.sizeM > 0 && Number.isFinite(world.sizeM));
    assert.ok([...world.anchor, ...world.boxEnu.min, ...world.boxEnu.max, world.groundM].every(Number.isFinite));
    assert.ok(world.boxEnu.min.every((low, i) => low < (world.boxEnu.max[i] ?? low)));
  }
});
