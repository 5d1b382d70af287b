// Models in the scene, with real shapes but without a graphics card: what is freed is counted by the events of three.js.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type BufferGeometry, LineSegments, type Material, Mesh, Plane, Vector3 } from "three";
import type { Vec3 } from "../../../src/base/vec.js";
import { norm, sub } from "../../../src/base/vec_math.js";
import { readModel } from "../../../src/scene/model_file.js";
import { ModelStore } from "../../../src/scene/model_store.js";
import type { ModelThing } from "../../../src/scene/thing.js";
import { ThingsLayer } from "../../../src/scene/things_layer.js";
import { makeWorld } from "../../../src/scene/world.js";
import { triangleGlb } from "./glb_samples.js";
import { sampleProject } from "./samples.js";

const WORLD = makeWorld(sampleProject());

function thing(id: string, patch: Partial<ModelThing> = {}): ModelThing {
  return { kind: "model", id, at: [10, 20, 5], yawDeg: 0, scale: 1, name: `name of ${id}`, url: "triangle", ...patch };
}

class Bench {
  loads: string[] = [];
  failures: string[] = [];
  changes = 0;
  readonly layer: ThingsLayer;

  constructor() {
    const store = new ModelStore({
      loadBytes: async (url) => {
        this.loads.push(url);
        if (url.startsWith("triangle")) return triangleGlb();
        throw new Error("the server answers 404");
      },
      read: (bytes) => readModel(bytes, true),
      keptBytes: 0,
    });
    this.layer = new ThingsLayer(WORLD, store, {
      changed: () => {
        this.changes += 1;
      },
      failed: (text) => this.failures.push(text),
    });
  }

  async set(...list: ModelThing[]): Promise<void> {
    this.layer.set(list);
    // Reading and making take a few turns each.
    for (let i = 0; i < 50 && this.layer.busy; i += 1) await new Promise((done) => setTimeout(done, 1));
  }

  objects(): { meshes: Mesh[]; lines: LineSegments[] } {
    const [meshes, lines]: [Mesh[], LineSegments[]] = [[], []];
    this.layer.scene.traverse((object) => {
      if (object instanceof Mesh) meshes.push(object);
      if (object instanceof LineSegments) lines.push(object);
    });
    return { meshes, lines };
  }
}

/** Counts how often what the objects use is freed. */
function watchDisposal(
  objects: readonly { geometry: BufferGeometry; material: Material | Material[] }[],
): () => number {
  const freed = new Set<object>();
  const parts = new Set<BufferGeometry | Material>();
  for (const { geometry, material } of objects) {
    parts.add(geometry);
    for (const one of Array.isArray(material) ? material : [material]) parts.add(one);
  }
  for (const part of parts) {
    const note = () => freed.add(part);
    if (part instanceof Object && "isMaterial" in part) part.addEventListener("dispose", note);
    else (part as BufferGeometry).addEventListener("dispose", note);
  }
  return () => parts.size - freed.size;
}

test("models of one file share its shape; each stands at its own place", async () => {
  const bench = new Bench();
  assert.equal(bench.layer.visible, false);
  await bench.set(thing("a"), thing("b", { at: [11, 20, 5], yawDeg: 90, scale: 2 }));
  assert.deepEqual(bench.loads, ["triangle"]);
  const { meshes } = bench.objects();
  assert.equal(meshes.length, 2);
  assert.equal(meshes[0]?.geometry, meshes[1]?.geometry);
  assert.ok(bench.layer.visible && bench.changes > 0);
  // The file's corner (0, 3, -4): 4 ahead, 3 up; for b by 2 and to the east.
  const corner = (i: number) => {
    const at = new Vector3(0, 3, -4).applyMatrix4(
      meshes[i]?.matrixWorld ?? meshes[0]?.matrixWorld ?? new Mesh().matrix,
    );
    return sub([at.x, at.y, at.z], [-WORLD.anchor[0], -WORLD.anchor[1], -WORLD.anchor[2]]);
  };
  assert.ok(norm(sub(corner(0), [10, 24, 8])) < 1e-5, `${corner(0)}`);
  assert.ok(norm(sub(corner(1), [19, 20, 11])) < 1e-5, `${corner(1)}`);
  const box = bench.layer.boxOf("b");
  assert.ok(box !== null && norm(sub(box.min, [11, 16, 5])) < 1e-9 && norm(sub(box.max, [19, 20, 11])) < 1e-9);
  assert.equal(bench.layer.boxOf("c"), null);
});

test("a list with the same things changes nothing; a moved one is not loaded again", async () => {
  const bench = new Bench();
  const [a, b] = [thing("a"), thing("b")];
  await bench.set(a, b);
  const { changes } = bench;
  await bench.set(a, b);
  assert.equal(bench.changes, changes);
  const [before] = bench.objects().meshes;
  await bench.set({ ...a, at: [0, 0, 0] }, b);
  assert.deepEqual(bench.loads, ["triangle"]);
  assert.equal(bench.objects().meshes[0], before);
  assert.ok(norm(sub(bench.layer.boxOf("a")?.min ?? [9, 9, 9], [0, 0, 0])) < 1e-9);
});

test("what the last thing of a file used is freed, and not before", async () => {
  const bench = new Bench();
  const [a, b] = [thing("a"), thing("b")];
  await bench.set(a, b);
  const left = watchDisposal(bench.objects().meshes);
  await bench.set(b);
  assert.equal(left(), 2);
  await bench.set({ ...b, url: "triangle 2" });
  assert.equal(left(), 0);
  assert.deepEqual(bench.loads, ["triangle", "triangle 2"]);
  const leftOfSecond = watchDisposal(bench.objects().meshes);
  bench.layer.dispose();
  assert.equal(leftOfSecond(), 0);
  assert.equal(bench.objects().meshes.length, 0);
});

test("what is replaced while it loads is never seen", async () => {
  const bench = new Bench();
  bench.layer.set([thing("a")]);
  await bench.set(thing("b", { url: "triangle 2" }));
  assert.equal(bench.objects().meshes.length, 1);
  assert.equal(bench.layer.boxOf("a"), null);
  assert.ok(bench.layer.boxOf("b") !== null);
});

test("a model that cannot be shown is named once; the others are there", async () => {
  const bench = new Bench();
  const [gone, here] = [thing("gone", { url: "missing.glb" }), thing("here")];
  await bench.set(gone, here);
  await bench.set(here, gone);
  await bench.set(here);
  await bench.set(here, gone);
  assert.deepEqual(bench.failures, ['The model "name of gone" cannot be shown: the server answers 404.']);
  assert.equal(bench.objects().meshes.length, 1);
});

test("the selected and the hovered one are outlined, and the outlines are freed", async () => {
  const bench = new Bench();
  await bench.set(thing("a"), thing("b", { at: [50, 0, 0] }));
  bench.layer.highlight("a", "b");
  const { lines } = bench.objects();
  // What is seen and what is hidden, of two models.
  assert.equal(lines.length, 4);
  const left = watchDisposal(lines);
  bench.layer.highlight("a", "a");
  assert.equal(bench.objects().lines.length, 2);
  assert.equal(left(), 0);
  bench.layer.highlight("nobody", null);
  assert.equal(bench.objects().lines.length, 0);
});

test("a ray meets the nearest model from both sides, inside the clip box only", async () => {
  const bench = new Bench();
  await bench.set(thing("near"), thing("far", { at: [10, 20, -5] }));
  const scene = (p: Vec3) => sub(p, WORLD.anchor);
  // Inside the triangle as seen from above: right of the origin by 0.5, ahead by 1; there it is 0.75 up.
  const down = bench.layer.pick(scene([10.5, 21, 100]), [0, 0, -1], null);
  assert.ok(down?.id === "near" && Math.abs(down.t - 94.25) < 1e-4, JSON.stringify(down));
  const up = bench.layer.pick(scene([10.5, 21, -100]), [0, 0, 1], null);
  assert.ok(up?.id === "far" && Math.abs(up.t - 95.75) < 1e-4, JSON.stringify(up));
  assert.equal(bench.layer.pick(scene([13, 21, 100]), [0, 0, -1], null), null);
  assert.equal(bench.layer.pick(scene([10.5, 21, 100]), [0, 0, -1], null, 90), null);
  const clip = { min: scene([0, 0, -50]), max: scene([100, 100, 0]) };
  assert.equal(bench.layer.pick(scene([10.5, 21, 100]), [0, 0, -1], clip)?.id, "far");
});

test("the corners that near and far must hold follow the models, but not to the end of the world", async () => {
  const bench = new Bench();
  await bench.set(thing("a"));
  assert.deepEqual(bench.layer.corners(), [
    [10, 20, 5],
    [12, 24, 8],
  ]);
  await bench.set(thing("a", { at: [1e9, 20, 5] }));
  const [corner] = bench.layer.corners();
  assert.ok(corner !== undefined && corner[0] < 20 * WORLD.sizeM && corner[0] > 5 * WORLD.sizeM && corner[1] === 20);
  await bench.set();
  assert.deepEqual(bench.layer.corners(), []);
});

test("the clip box reaches models that come later too", async () => {
  const bench = new Bench();
  const planes = [new Plane(new Vector3(0, 0, 1), 0)];
  bench.layer.setClip(planes);
  await bench.set(thing("a"));
  bench.layer.highlight("a", null);
  const { meshes, lines } = bench.objects();
  for (const object of [...meshes, ...lines]) {
    for (const material of [object.material].flat()) assert.equal(material.clippingPlanes, planes);
  }
});
