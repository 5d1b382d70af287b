// Which map of errors is laid over the surface, with files that answer when the test says so.
import assert from "node:assert/strict";
import { type TestContext, test } from "node:test";
import { MapDrape } from "../../../src/scene/map_drape.js";
import type { Drape } from "../../../src/scene/surface_style.js";
import type { World } from "../../../src/scene/world.js";
import type { DrapedMap } from "../../../src/state/app_state.js";

const WORLD: World = { anchor: [10, 20, 0], boxEnu: { min: [0, 0, 0], max: [9, 9, 9] }, groundM: 0, sizeM: 9 };
const HELD_OUT: DrapedMap = { url: "/data/pictures/1.png", min: [11, 22], max: [33, 44], scale: 0.1 };
const TRUST: DrapedMap = { url: "/data/pictures/2.png", min: [10, 20], max: [30, 40], scale: 0.25 };

function bench(t: TestContext) {
  const files: { url: string; signal: AbortSignal; answer: (response: Response) => void }[] = [];
  const closed: number[] = [];
  const shown: (Drape | null)[] = [];
  const failures: string[] = [];
  let made = 0;
  const before = { fetch: globalThis.fetch, createImageBitmap: globalThis.createImageBitmap };
  t.after(() => Object.assign(globalThis, before));
  Object.assign(globalThis, {
    fetch: (url: string, { signal }: { signal: AbortSignal }) =>
      new Promise((answer) => files.push({ url, signal, answer })),
    createImageBitmap: () => {
      made += 1;
      const number = made;
      return Promise.resolve({ close: () => closed.push(number) });
    },
  });
  const drape = new MapDrape(WORLD, {
    changed: (next) => shown.push(next),
    failed: (text) => failures.push(text),
  });
  const answer = async (file: number, status = 200) => {
    files[file]?.answer(new Response("", { status }));
    await new Promise((done) => setTimeout(done, 0));
  };
  return { drape, files, closed, shown, failures, answer };
}

test("another map takes the place of the first, which is not shown while the new one is loaded", async (t) => {
  const { drape, files, closed, shown, answer } = bench(t);
  drape.show(HELD_OUT);
  assert.ok(drape.busy);
  await answer(0);
  assert.deepEqual(shown.at(-1)?.min.toArray(), [1, 2]);
  assert.deepEqual(shown.at(-1)?.max.toArray(), [23, 24]);
  drape.show(TRUST);
  assert.equal(shown.at(-1), null);
  await answer(1);
  assert.deepEqual(shown.at(-1)?.max.toArray(), [20, 20]);
  assert.deepEqual(closed, [1]);
  drape.show(null);
  assert.equal(shown.at(-1), null);
  drape.show(TRUST);
  assert.deepEqual(shown.at(-1)?.max.toArray(), [20, 20]);
  assert.deepEqual(
    files.map(({ url }) => url),
    [HELD_OUT.url, TRUST.url],
    "what is loaded is not fetched again",
  );
  drape.dispose();
  assert.deepEqual(closed, [1, 2]);
});

test("a map that is no longer wanted is not shown when it comes, and a failure is told", async (t) => {
  const { drape, files, closed, shown, failures, answer } = bench(t);
  drape.show(HELD_OUT);
  drape.show(TRUST);
  assert.ok(files[0]?.signal.aborted);
  await answer(0);
  assert.deepEqual(closed, [1]);
  await answer(1, 404);
  assert.ok(!drape.busy);
  assert.ok(shown.every((drape) => drape === null));
  assert.deepEqual(failures, ["The map of errors cannot be shown: the server answers 404"]);
});
