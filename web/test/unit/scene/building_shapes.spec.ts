import assert from "node:assert/strict";
import { test } from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { add, cross, dot, norm, normalize, quatRotate, sub } from "../../../src/base/vec_math.js";
import { solidEdges, solidMesh, triangulateFace } from "../../../src/scene/building_shapes.js";
import { BuildingsLayer, watchBuildings } from "../../../src/scene/buildings_layer.js";
import { makeWorld } from "../../../src/scene/world.js";
import { initialState } from "../../../src/state/initial.js";
import { Store } from "../../../src/state/store.js";
import { boxSolid, sampleBuilding, sampleSet } from "../state/building_samples.js";
import { sampleProject } from "./samples.js";

function trianglesOf(vertices: readonly Vec3[], rings: readonly (readonly number[])[]): Vec3[] {
  const corners = triangulateFace(vertices, { kind: "roof", rings });
  const areas: Vec3[] = [];
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => vertices[corners[i + k] ?? -1]);
    assert.ok(a !== undefined && b !== undefined && c !== undefined, "a corner that the face does not have");
    const twice = cross(sub(b, a), sub(c, a));
    areas.push([twice[0] / 2, twice[1] / 2, twice[2] / 2]);
  }
  return areas;
}

/** The same face in any direction of space, with its own area and turned as it is. */
function checkFace(
  flat: readonly (readonly [number, number])[],
  rings: readonly (readonly number[])[],
  area: number,
): void {
  const turns = [
    [1, 0, 0, 0],
    [0, 1, 0, 0],
    [0.5, 0.5, 0.5, 0.5],
    [0.8, 0.36, -0.48, 0],
  ] as const;
  for (const turn of turns) {
    const vertices = flat.map(([x, y]) => add(quatRotate(turn, [x, y, 0]), [300, -200, 50]));
    const normal = quatRotate(turn, [0, 0, 1]);
    const areas = trianglesOf(vertices, rings);
    const sum = areas.reduce((total, one) => total + norm(one), 0);
    assert.ok(Math.abs(sum - area) < 1e-6 * area, `${sum} instead of ${area}`);
    for (const one of areas) assert.ok(dot(normalize(one), normal) > 0.999, "a triangle shows its back");
  }
}

test("faces keep their area: convex, notched, with one and with two holes", () => {
  checkFace(
    [
      [0, 0],
      [4, 0],
      [4, 3],
      [0, 3],
    ],
    [[0, 1, 2, 3]],
    12,
  );
  checkFace(
    [
      [0, 0],
      [6, 0],
      [6, 2],
      [2, 2],
      [2, 5],
      [0, 5],
    ],
    [[0, 1, 2, 3, 4, 5]],
    18,
  );
  // Courtyards are written clockwise.
  const outer = [
    [0, 0],
    [10, 0],
    [10, 8],
    [0, 8],
  ] as const;
  const hole = (x: number, y: number) =>
    [
      [x, y],
      [x, y + 2],
      [x + 3, y + 2],
      [x + 3, y],
    ] as const;
  checkFace(
    [...outer, ...hole(1, 1)],
    [
      [0, 1, 2, 3],
      [4, 5, 6, 7],
    ],
    74,
  );
  checkFace(
    [...outer, ...hole(1, 1), ...hole(5, 4)],
    [
      [0, 1, 2, 3],
      [4, 5, 6, 7],
      [8, 9, 10, 11],
    ],
    68,
  );
});

test("repeated corners do not shift the numbers of holes", () => {
  const flat = [
    [0, 0],
    [10, 0],
    [10, 8],
    [0, 8],
    [1, 1],
    [1, 3],
    [4, 3],
    [4, 1],
  ] as const;
  checkFace(
    flat,
    [
      [0, 0, 1, 2, 3, 0],
      [4, 5, 6, 7, 4],
    ],
    74,
  );
});

test("faces without area give nothing", () => {
  const line: Vec3[] = [
    [0, 0, 0],
    [1, 0, 0],
    [2, 0, 0],
  ];
  assert.deepEqual(triangulateFace(line, { kind: "wall", rings: [[0, 1, 2]] }), []);
  assert.deepEqual(triangulateFace(line, { kind: "wall", rings: [[0, 0, 0]] }), []);
  assert.deepEqual(triangulateFace([], { kind: "wall", rings: [] }), []);
});

test("a solid far away keeps its centimetres, and its volume is that of the box", () => {
  const anchor: Vec3 = [40_000, -30_000, 500];
  const solid = boxSolid(add(anchor, [1, 2, 3]), add(anchor, [11.01, 8.02, 7.03]));
  const { positions, kinds } = solidMesh(solid, anchor);
  assert.equal(kinds.length, 12);
  let volume = 0;
  for (let i = 0; i < positions.length; i += 9) {
    const corner = (k: number): Vec3 => [positions[i + k] ?? 0, positions[i + k + 1] ?? 0, positions[i + k + 2] ?? 0];
    volume += dot(corner(0), cross(corner(3), corner(6))) / 6;
  }
  assert.ok(Math.abs(volume - 10.01 * 6.02 * 4.03) < 1e-3, `${volume}`);
  assert.equal(solidEdges(solid, anchor).length, 12 * 6, "each of 12 edges once");
});

const PROJECT = sampleProject();
const WORLD = makeWorld(PROJECT);

function layerOf(): BuildingsLayer {
  const layer = new BuildingsLayer(WORLD);
  layer.setBuildings(
    sampleSet([
      sampleBuilding(3, { solid: boxSolid([0, 0, 0], [10, 10, 5]) }),
      sampleBuilding(7, { solid: boxSolid([20, 0, 0], [30, 10, 5]), accepted: false }),
    ]),
  );
  return layer;
}

test("the nearest building under the pointer is found", () => {
  const layer = layerOf();
  const from = (enu: Vec3) => sub(enu, WORLD.anchor);
  assert.equal(layer.pick(from([5, 5, 50]), [0, 0, -1], null), 3);
  assert.equal(layer.pick(from([25, 5, 50]), [0, 0, -1], null), 7);
  assert.equal(layer.pick(from([15, 5, 50]), [0, 0, -1], null), null);
  assert.equal(layer.pick(from([-50, 5, 2]), [1, 0, 0], null), 3);
  assert.equal(layer.pick(from([50, 5, 2]), [-1, 0, 0], null), 7);
  const clip = { min: from([18, -5, -1]), max: from([40, 20, 20]) };
  assert.equal(layer.pick(from([-50, 5, 2]), [1, 0, 0], clip), 7, "what is clipped away hides nothing");
  layer.dispose();
  assert.equal(layer.pick(from([5, 5, 50]), [0, 0, -1], null), null);
});

test("the layer follows the store and frees what it made", () => {
  const store = new Store(initialState(PROJECT));
  const layer = new BuildingsLayer(WORLD);
  let drawn = 0;
  const end = watchBuildings(store, layer, () => {
    drawn += 1;
  });
  const meshes = () => {
    let count = 0;
    layer.scene.traverse((object) => {
      if ("geometry" in object) count += 1;
    });
    return count;
  };
  assert.equal(layer.visible, false);
  store.set({ buildings: { set: sampleSet([sampleBuilding(3), sampleBuilding(4)]), loading: false, error: "" } });
  assert.equal(layer.visible, false, "the layer is off");
  store.update(({ layers }) => ({ layers: { ...layers, buildings: true } }));
  assert.equal(layer.visible, true);
  const plain = meshes();
  store.set({ selectedBuilding: 4 });
  store.set({ hoverBuilding: 3 });
  assert.ok(meshes() > plain);
  store.set({ selectedBuilding: null, hoverBuilding: 99 });
  assert.equal(meshes(), plain, "marks go away");
  assert.ok(drawn >= 5);
  end();
  store.set({ buildings: { set: null, loading: false, error: "" } });
  assert.equal(layer.visible, true, "nothing follows after the end");
  layer.dispose();
  assert.equal(meshes(), 0);
});
