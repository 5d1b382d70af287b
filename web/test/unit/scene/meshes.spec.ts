import assert from "node:assert/strict";
import { test } from "node:test";
import { BufferAttribute, BufferGeometry, Group, Mesh, MeshBasicMaterial } from "three";
import type { Vec3 } from "../../../src/base/vec.js";
import { makeCoarse } from "../../../src/scene/coarse_mesh.js";
import { pickSurfaces } from "../../../src/scene/picking.js";
import { meetsBox, nearestHit } from "../../../src/scene/ray_mesh.js";
import type { Surface } from "../../../src/scene/surface.js";

/** A square of n x n cells at height z over [0, size], counter-clockwise from above. */
function sheet(n: number, size: number, z: (x: number, y: number) => number) {
  const positions: number[] = [];
  const uvs: number[] = [];
  const indices: number[] = [];
  for (let j = 0; j <= n; j += 1) {
    for (let i = 0; i <= n; i += 1) {
      const [x, y] = [(size * i) / n, (size * j) / n];
      positions.push(x, y, z(x, y));
      uvs.push(i / n, j / n);
      const a = j * (n + 1) + i;
      if (i < n && j < n) indices.push(a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
    }
  }
  return { positions: Float32Array.from(positions), uvs: Float32Array.from(uvs), indices: Uint32Array.from(indices) };
}

test("the nearest front side is hit", () => {
  const low = sheet(4, 8, () => 1);
  const high = sheet(4, 8, () => 3);
  const shifted = high.indices.map((i) => i + low.positions.length / 3);
  const both = {
    positions: Float32Array.from([...low.positions, ...high.positions]),
    indices: Uint32Array.from([...low.indices, ...shifted]),
  };
  assert.ok(Math.abs(nearestHit(both, [3, 3, 10], [0, 0, -1]) - 7) < 1e-6);
  // What is refused is looked through.
  assert.ok(Math.abs(nearestHit(both, [3, 3, 10], [0, 0, -1], Number.POSITIVE_INFINITY, (t) => t > 8) - 9) < 1e-6);
  assert.equal(nearestHit(both, [3, 3, 10], [0, 0, -1], 6), Number.POSITIVE_INFINITY);
  // From below only back sides are seen, which are not drawn.
  assert.equal(nearestHit(both, [3, 3, -10], [0, 0, 1]), Number.POSITIVE_INFINITY);
  assert.equal(nearestHit(both, [9, 3, 10], [0, 0, -1]), Number.POSITIVE_INFINITY);
});

test("no ray slips through between triangles", () => {
  const mesh = sheet(10, 1, (x, y) => 0.3 * Math.sin(9 * x) * Math.cos(7 * y));
  for (let i = 1; i < 200; i += 1) {
    const at = (i % 20) / 20 + 0.05 * Math.floor(i / 20) * 0.1;
    const origin: Vec3 = [Math.min(0.999, at), Math.min(0.999, i / 200), 5];
    assert.ok(Number.isFinite(nearestHit(mesh, origin, [0, 0, -1])), `${origin}`);
  }
});

test("boxes are met from outside and inside", () => {
  assert.ok(meetsBox([0, 0, 0], [1, 1, 1], [0.5, 0.5, 5], [0, 0, -1]));
  assert.ok(meetsBox([0, 0, 0], [1, 1, 1], [0.5, 0.5, 0.5], [1, 0, 0]));
  assert.ok(!meetsBox([0, 0, 0], [1, 1, 1], [0.5, 0.5, 5], [0, 0, 1]));
  assert.ok(!meetsBox([0, 0, 0], [1, 1, 1], [2, 0.5, 5], [0, 0, -1]));
  assert.ok(!meetsBox([0, 0, 0], [1, 1, 1], [0.5, 0.5, 5], [0, 0, -1], 3));
});

function surfaceOf(mesh: Mesh): Surface {
  return {
    object: mesh,
    update: () => {},
    eachMesh: (visit) => visit(mesh, mesh.geometry),
    busy: false,
    dispose: () => {},
  };
}

test("meshes are picked where they stand, in metres, and the clip box counts", () => {
  const { positions, indices } = sheet(4, 8, () => 2);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(indices, 1));
  const mesh = new Mesh(geometry, new MeshBasicMaterial());
  const group = new Group();
  group.add(mesh);
  group.position.set(100, 50, 10);
  group.rotation.z = Math.PI / 2;
  mesh.scale.setScalar(2);
  group.updateMatrixWorld(true);
  // x of the sheet is y of the scene; its y is -x. It covers x from 84 to 100, y from 50 to 66 at z = 14.
  const surfaces = [surfaceOf(mesh)];
  const t = pickSurfaces(surfaces, [90, 60, 30], [0, 0, -1], null);
  assert.ok(t !== null && Math.abs(t - 16) < 1e-5, `${t}`);
  assert.equal(pickSurfaces(surfaces, [101, 60, 30], [0, 0, -1], null), null);
  assert.equal(pickSurfaces(surfaces, [90, 60, 30], [0, 0, -1], { min: [0, 0, 0], max: [200, 200, 13] }), null);
  assert.notEqual(pickSurfaces(surfaces, [90, 60, 30], [0, 0, -1], { min: [0, 0, 0], max: [200, 200, 15] }), null);
});

test("a coarse mesh has fewer triangles at the same place, with the texture where it was", () => {
  const coarse = makeCoarse(
    sheet(40, 20, (x, y) => 0.1 * x + 0.05 * y),
    2,
  );
  assert.ok(coarse !== null && coarse.indices !== null);
  const triangles = coarse.indices.length / 3;
  assert.ok(triangles > 50 && triangles < 400, `${triangles}`);
  for (let i = 0; i < coarse.positions.length / 3; i += 1) {
    const [x, y, z] = [
      coarse.positions[3 * i] ?? 0,
      coarse.positions[3 * i + 1] ?? 0,
      coarse.positions[3 * i + 2] ?? 0,
    ];
    assert.ok(Math.abs(z - 0.1 * x - 0.05 * y) < 1e-4);
    assert.ok(
      Math.abs((coarse.uvs[2 * i] ?? 0) - x / 20) < 1e-5 && Math.abs((coarse.uvs[2 * i + 1] ?? 0) - y / 20) < 1e-5,
    );
  }
  assert.ok(Number.isFinite(nearestHit(coarse, [10.3, 9.7, 20], [0, 0, -1])), "it still faces up");
});

test("parts of the texture keep vertices of their own, at one common place", () => {
  // Two sheets side by side that share an edge in space but not in the texture.
  const [a, b] = [sheet(10, 10, () => 0), sheet(10, 10, () => 0)];
  const count = a.positions.length / 3;
  const positions = Float32Array.from([
    ...a.positions,
    ...b.positions.map((value, i) => (i % 3 === 0 ? value + 10 : value)),
  ]);
  const uvs = Float32Array.from([...a.uvs.map((v) => 0.4 * v), ...b.uvs.map((v) => 0.6 + 0.4 * v)]);
  const coarse = makeCoarse(
    { positions, uvs, indices: Uint32Array.from([...a.indices, ...b.indices.map((i) => i + count)]) },
    2.5,
  );
  assert.ok(coarse !== null);
  const places = new Map<string, Set<string>>();
  for (let i = 0; i < coarse.positions.length / 3; i += 1) {
    const u = coarse.uvs[2 * i] ?? 0;
    assert.ok(u <= 0.4 + 1e-6 || u >= 0.6 - 1e-6, `texture is mixed across the seam: ${u}`);
    const key = coarse.positions.slice(3 * i, 3 * i + 3).join();
    places.set(key, (places.get(key) ?? new Set()).add(u < 0.5 ? "a" : "b"));
  }
  assert.ok(
    [...places.values()].some((charts) => charts.size === 2),
    "no common place at the seam",
  );
  // A ray beside the seam finds no gap.
  for (let y = 1; y < 9; y += 0.37)
    assert.ok(Number.isFinite(nearestHit(coarse, [10, y, 5], [0, 0, -1])), `gap at ${y}`);
});

test("meshes that would not shrink, or are broken, are left alone", () => {
  const fine = sheet(5, 10, () => 0);
  assert.equal(makeCoarse(fine, 0.1), null);
  assert.equal(makeCoarse(fine, 0), null);
  assert.equal(makeCoarse({ ...fine, indices: null }, 5), null);
  assert.equal(makeCoarse({ ...fine, uvs: new Float32Array(2) }, 5), null);
  assert.equal(
    makeCoarse({ positions: new Float32Array(0), uvs: new Float32Array(0), indices: new Uint16Array(0) }, 1),
    null,
  );
});
