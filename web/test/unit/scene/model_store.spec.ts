// Loading and freeing of models, with files that are only names.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Object3D } from "three";
import type { Model } from "../../../src/scene/model.js";
import { ModelStore } from "../../../src/scene/model_store.js";

interface Pending {
  readonly url: string;
  readonly signal: AbortSignal;
  resolve(bytes: ArrayBuffer): void;
  reject(error: Error): void;
}

class Bench {
  readonly pending: Pending[] = [];
  made = 0;
  freed = 0;
  readonly store: ModelStore;

  constructor(mostBytes = 1000, mostLoads = 2, keptBytes = 0) {
    this.store = new ModelStore({
      loadBytes: (url, signal) => new Promise((resolve, reject) => this.pending.push({ url, signal, resolve, reject })),
      // A file's length is what it needs.
      read: (bytes) => {
        if (bytes.byteLength === 0) throw new Error("it is empty");
        return {
          bytes: bytes.byteLength,
          make: async (): Promise<Model> => {
            await Promise.resolve();
            if (bytes.byteLength === 13) throw new Error("unlucky");
            this.made += 1;
            const dispose = () => {
              this.freed += 1;
            };
            return { object: new Object3D(), box: { min: [0, 0, 0], max: [1, 1, 1] }, dispose };
          },
        };
      },
      mostBytes,
      mostLoads,
      keptBytes,
    });
  }

  async give(url: string, bytes: number): Promise<void> {
    const at = this.pending.findIndex((load) => load.url === url);
    const [load] = this.pending.splice(at, 1);
    load?.resolve(new ArrayBuffer(bytes));
    await settle();
  }
}

async function settle(): Promise<void> {
  for (let i = 0; i < 20; i += 1) await Promise.resolve();
}

test("a file is loaded once for all who show it, and freed with the last of them", async () => {
  const bench = new Bench();
  const got: unknown[] = [];
  const first = bench.store.acquire("a", (outcome) => got.push(outcome));
  const second = bench.store.acquire("a", (outcome) => got.push(outcome));
  assert.equal(bench.pending.length, 1);
  await bench.give("a", 100);
  assert.equal(got.length, 2);
  const third = bench.store.acquire("a", (outcome) => got.push(outcome));
  await settle();
  assert.equal(got.length, 3);
  assert.ok(got.every((one) => one === got[0] && !(one instanceof Error)));
  assert.equal(bench.store.bytes, 100);
  first();
  second();
  second();
  assert.equal(bench.freed, 0);
  third();
  assert.deepEqual([bench.made, bench.freed, bench.store.bytes, bench.store.busy], [1, 1, 0, false]);
});

test("a load that is no longer wanted is ended, and what comes all the same is freed unseen", async () => {
  const bench = new Bench();
  let got = 0;
  bench.store.acquire("a", () => {
    got += 1;
  })();
  assert.equal(bench.pending[0]?.signal.aborted, true);
  await bench.give("a", 100);
  // Given up while it is being made.
  const release = bench.store.acquire("b", () => {
    got += 1;
  });
  bench.pending.find(({ url }) => url === "b")?.resolve(new ArrayBuffer(100));
  await Promise.resolve();
  await Promise.resolve();
  release();
  await settle();
  assert.equal(got, 0);
  assert.equal(bench.freed, bench.made);
  assert.equal(bench.store.bytes, 0);
});

test("the same file wanted again while its first load ends is loaded anew", async () => {
  const bench = new Bench();
  bench.store.acquire("a", () => assert.fail("given up"))();
  const got: unknown[] = [];
  bench.store.acquire("a", (outcome) => got.push(outcome));
  bench.pending[0]?.reject(new Error("aborted"));
  await settle();
  assert.equal(got.length, 0);
  bench.pending[1]?.resolve(new ArrayBuffer(10));
  await settle();
  assert.equal(got.length, 1);
  assert.ok(!(got[0] instanceof Error));
  assert.equal(bench.store.bytes, 10);
});

test("few at a time, the others after them", async () => {
  const bench = new Bench(1000, 2);
  for (const url of ["a", "b", "c", "d"]) bench.store.acquire(url, () => {});
  assert.deepEqual(
    bench.pending.map(({ url }) => url),
    ["a", "b"],
  );
  await bench.give("b", 1);
  assert.deepEqual(
    bench.pending.map(({ url }) => url),
    ["a", "c"],
  );
  assert.ok(bench.store.busy);
});

test("the limit of memory holds, and what was freed can be used again", async () => {
  const bench = new Bench(100);
  const outcomes = new Map<string, unknown>();
  const acquire = (url: string) => bench.store.acquire(url, (outcome) => outcomes.set(url, outcome));
  const release = acquire("a");
  await bench.give("a", 60);
  acquire("b");
  await bench.give("b", 41);
  assert.match(String(outcomes.get("b")), /memory/);
  assert.equal(bench.store.bytes, 60);
  release();
  acquire("c");
  await bench.give("c", 100);
  assert.ok(!(outcomes.get("c") instanceof Error));
});

test("what nothing shows any more is kept for a while, the newest longest, and gives way", async () => {
  const bench = new Bench(200, 2, 100);
  const take = async (url: string, bytes: number): Promise<() => void> => {
    const release = bench.store.acquire(url, (outcome) => assert.ok(!(outcome instanceof Error), String(outcome)));
    await bench.give(url, bytes);
    return release;
  };
  (await take("a", 50))();
  (await take("b", 50))();
  assert.deepEqual([bench.freed, bench.store.bytes], [0, 100]);
  // Shown again without being loaded; then it is the newest.
  const again = bench.store.acquire("a", () => {});
  assert.equal(bench.pending.length, 0);
  again();
  (await take("c", 50))();
  assert.deepEqual([bench.freed, bench.store.bytes], [1, 100]);
  bench.store.acquire("a", () => {});
  assert.equal(bench.pending.length, 0, "a was freed before b");
  await take("d", 150);
  assert.deepEqual([bench.freed, bench.store.bytes], [2, 200]);
  bench.store.dispose();
  assert.deepEqual([bench.freed, bench.store.bytes], [4, 0]);
});

test("errors come once to each user and hold no memory", async () => {
  const bench = new Bench();
  const errors: string[] = [];
  const note = (outcome: unknown) => errors.push(String(outcome));
  bench.store.acquire("gone", note);
  bench.store.acquire("empty", note);
  bench.store.acquire("unlucky", note);
  bench.pending[0]?.reject(new Error("the server answers 404"));
  await settle();
  await bench.give("empty", 0);
  await bench.give("unlucky", 13);
  assert.deepEqual(errors, ["Error: the server answers 404", "Error: it is empty", "Error: unlucky"]);
  assert.equal(bench.store.bytes, 0);
  assert.equal(bench.store.busy, false);
});

test("at the end everything is freed", async () => {
  const bench = new Bench();
  bench.store.acquire("a", () => {});
  bench.store.acquire("b", () => {});
  await bench.give("a", 10);
  bench.store.dispose();
  await bench.give("b", 10);
  assert.equal(bench.freed, bench.made);
  assert.deepEqual([bench.store.bytes, bench.store.busy], [0, false]);
});
