import assert from "node:assert/strict";
import test from "node:test";
import { ManualClock } from "../../../src/base/clock.js";
import { isFileName, PackedFiles, packedName } from "../../../src/protocol/packed_files.js";

/** The scripts that the page would run. */
function page() {
  const added: { url: string; ran: () => void; failed: () => void; removed: boolean }[] = [];
  const clock = new ManualClock();
  const files = new PackedFiles({
    clock,
    mostWaitMs: 1000,
    scripts: {
      add: (url, ran, failed) => {
        const script = { url, ran, failed, removed: false };
        added.push(script);
        return () => {
          script.removed = true;
        };
      },
    },
  });
  /** The newest script runs. */
  const run = (name: unknown, base64: unknown) => {
    files.receive(name, base64);
    added.at(-1)?.ran();
  };
  return { files, clock, added, run };
}

test("a file is loaded once, by a script of its name", async () => {
  const { files, clock, added, run } = page();
  const first = files.load("stops/s 1/süd.jpg");
  const second = files.load("stops/s 1/süd.jpg");
  assert.deepEqual(
    added.map(({ url }) => url),
    ["data/stops/s%201/s%C3%BCd.jpg.js"],
  );
  run("stops/s 1/süd.jpg", "AQID");
  assert.deepEqual([...(await first)], [1, 2, 3]);
  assert.equal(await second, await first);
  assert.equal(await files.load("stops/s 1/süd.jpg"), await first);
  assert.equal(added.length, 1);
  assert.equal(added[0]?.removed, true);
  assert.equal(clock.waiting, 0);
});

test("files come in any order", async () => {
  const { files, added, run } = page();
  const a = files.load("a");
  const b = files.load("b");
  run("b", "Ag==");
  files.receive("a", "AQ==");
  added[0]?.ran();
  assert.deepEqual([...(await a), ...(await b)], [1, 2]);
});

test("a file that was released is read again, one that is loaded is not replaced", async () => {
  const { files, added, run } = page();
  const first = files.load("a");
  run("a", "AQ==");
  await first;
  files.receive("a", "Ag==");
  assert.deepEqual([...(await files.load("a"))], [1]);
  files.release("a");
  const again = files.load("a");
  assert.equal(added.length, 2);
  run("a", "Aw==");
  assert.deepEqual([...(await again)], [3]);
});

test("a file whose script is in the page itself needs no other", async () => {
  const { files, added } = page();
  files.receive("project.json", "e30=");
  assert.deepEqual([...(await files.load("project.json"))], [0x7b, 0x7d]);
  assert.equal(added.length, 0);
});

test("what is missing, damaged, another file or silent is an error that says so, and can be tried again", async () => {
  const { files, clock, added, run } = page();
  const missing = files.load("a");
  added[0]?.failed();
  await assert.rejects(missing, /data\/a\.js could not be loaded: the folder/);
  const damaged = files.load("a");
  run("a", "A!!!");
  await assert.rejects(damaged, /data\/a\.js is damaged, it is not base64/);
  const another = files.load("a");
  run("b", "AQ==");
  await assert.rejects(another, /data\/a\.js is damaged, it holds something else/);
  const silent = files.load("a");
  clock.advance(1000);
  await assert.rejects(silent, /data\/a\.js did not come within 1 s/);
  const right = files.load("a");
  // Late events of the one that was given up.
  added[3]?.failed();
  run("a", "AQ==");
  assert.deepEqual([...(await right)], [1]);
  assert.equal(clock.waiting, 0);
  assert.ok(added.every(({ removed }) => removed));
});

test("names stay below data/", async () => {
  const { files, added } = page();
  for (const name of ["", "/a", "a/", "a//b", "../a", "a/../b", "./a", "a\\b", "a\u0000", "\ud800", "x".repeat(301)]) {
    assert.ok(!isFileName(name), name);
    await assert.rejects(files.load(name), /no name of a file/);
  }
  assert.equal(added.length, 0);
  // A colon or a question mark is part of the name, and leads nowhere else.
  void files.load("javascript:x?y#z").catch(() => {});
  assert.equal(added[0]?.url, "data/javascript%3Ax%3Fy%23z.js");
});

test("addresses of the viewer's server have a file here", () => {
  assert.equal(packedName("/data/tiles/tileset.json"), "tiles/tileset.json");
  assert.equal(packedName("file:///data/tiles/0/1.glb"), "tiles/0/1.glb");
  assert.equal(packedName("file:///C:/data/tiles/a%20b.glb"), "tiles/a b.glb");
  assert.equal(packedName("https://a.example/data/terrain.bin?r=3"), "terrain.bin");
  assert.equal(packedName(`/data/tour/assets/${"0".repeat(64)}.glb`), `assets/${"0".repeat(64)}.glb`);
  for (const url of [
    "/dat/a",
    "data/a",
    "/other/data/a",
    "/data/",
    "/data/../a",
    "/data/%2e%2e/a",
    "/data/%zz",
    "blob:null/1",
  ])
    assert.equal(packedName(url), null, url);
});
