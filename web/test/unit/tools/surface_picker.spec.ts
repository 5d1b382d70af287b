import assert from "node:assert/strict";
import test from "node:test";
import { AbortError } from "../../../src/base/abort.js";
import { insideBox, SurfacePicker, shownAt } from "../../../src/tools/surface_picker.js";
import { bench, hitAt, NO_HIT, settle } from "./fakes.js";

test("the field's point replaces the mesh's where it hits", async () => {
  const b = bench();
  const picker = new SurfacePicker(b);
  const { mesh, field } = picker.pick([3, 4]);
  assert.deepEqual(mesh?.enu, [3, -4, 0]);
  await settle();
  assert.deepEqual(b.engine.picks[0]?.asked.ray.originEnu, [3, -4, 100]);
  b.engine.picks[0]?.resolve(hitAt(3, -4));
  const found = await field;
  assert.deepEqual(found, { enu: [3, -4, 0.5], direction: [0, 0, -1], spreadM: 0.05, pixelM: 0.0995, source: "field" });
});

test("without a hit, with broken numbers or without an engine there is none", async () => {
  const b = bench();
  const picker = new SurfacePicker(b);
  for (const answer of [
    NO_HIT,
    { ...hitAt(0, 0), point: [Number.NaN, 0, 0] as const },
    { ...hitAt(0, 0), depthM: Number.NaN },
  ]) {
    const { field } = picker.pick([0, 0]);
    await settle();
    b.engine.picks.pop()?.resolve(answer);
    assert.equal(await field, null);
  }
  b.store.update(({ engine }) => ({ engine: { ...engine, ready: false } }));
  assert.equal(await picker.pick([0, 0]).field, null);
  assert.equal(b.engine.picks.length, 0);
});

test("places are asked one after the other, so that none replaces another", async () => {
  const b = bench();
  const picker = new SurfacePicker(b);
  const fields = [1, 2, 3].map((x) => picker.pick([x, 0]).field);
  for (let i = 0; i < 3; i += 1) {
    await settle();
    assert.equal(b.engine.picks.length, i + 1);
    b.engine.picks[i]?.resolve(hitAt(i + 1, 0));
  }
  await picker.idle();
  assert.deepEqual(
    (await Promise.all(fields)).map((point) => point?.enu[0]),
    [1, 2, 3],
  );
});

test("a pick that somebody else's replaced is asked again; an error is told and the mesh's point stays", async () => {
  const b = bench();
  const picker = new SurfacePicker(b);
  const { field } = picker.pick([1, 0]);
  await settle();
  b.engine.picks[0]?.reject(new AbortError());
  await settle();
  b.engine.picks[1]?.resolve(hitAt(1, 0));
  assert.notEqual(await field, null);
  const second = picker.pick([1, 0]).field;
  await settle();
  b.engine.picks[2]?.reject(new Error("the engine is busy"));
  assert.equal(await second, null);
  assert.match(b.store.get().notices[0]?.text ?? "", /the engine is busy/);
});

test("with a clip box the ray begins where it enters the box and ends where it leaves it", async () => {
  const b = bench();
  b.store.set({ clip: { on: true, min: [-50, -50, -10], max: [50, 50, 20] } });
  const picker = new SurfacePicker(b);
  const { field } = picker.pick([3, 4]);
  await settle();
  const { ray } = b.engine.picks[0]?.asked ?? assert.fail();
  assert.deepEqual(ray.originEnu, [3, -4, 20]);
  assert.ok(Math.abs(ray.pixelWidthM - 0.08) < 1e-12);
  b.engine.picks[0]?.resolve({ ...hitAt(3, -4), depthM: 19.5 });
  assert.ok(Math.abs(((await field)?.pixelM ?? 0) - 0.0995) < 1e-12);
  const below = picker.pick([3, 4]).field;
  await settle();
  b.engine.picks[1]?.resolve({ ...hitAt(3, -4), depthM: 31 });
  assert.equal(await below, null);
  assert.equal(await picker.pick([300, 4]).field, null);
  assert.equal(b.engine.picks.length, 2);
});

test("a ray in a box", () => {
  const box = { min: [0, 0, 0], max: [1, 2, 3] } as const;
  assert.deepEqual(insideBox({ originEnu: [-1, 1, 1], direction: [2, 0, 0] }, box), { startM: 1, endM: 2 });
  assert.deepEqual(insideBox({ originEnu: [0.5, 1, 1], direction: [0, 0, -1] }, box), { startM: 0, endM: 1 });
  assert.equal(insideBox({ originEnu: [-1, 1, 1], direction: [-1, 0, 0] }, box), null);
  assert.equal(insideBox({ originEnu: [-1, 5, 1], direction: [1, 0, 0] }, box), null);
});

test("left of the swipe's line the earlier project is asked", async () => {
  const b = bench();
  b.store.set({ swipe: { on: true, at: 0.5 } });
  assert.equal(shownAt(b.store.get(), [399, 0], 800), "before");
  assert.equal(shownAt(b.store.get(), [400, 0], 800), "main");
  void new SurfacePicker(b).pick([10, 0]);
  await settle();
  assert.equal(b.engine.picks[0]?.asked.project, "before");
  b.store.set({ swipe: { on: false, at: 0.5 } });
  assert.equal(shownAt(b.store.get(), [10, 0], 800), "main");
});
