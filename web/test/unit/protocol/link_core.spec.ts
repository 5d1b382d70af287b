import assert from "node:assert/strict";
import test from "node:test";
import { isAbort } from "../../../src/base/abort.js";
import type { Quat, Vec3 } from "../../../src/base/vec.js";
import { LOST } from "../../../src/protocol/link_core.js";
import type { DecodedFrame, LinkStatus } from "../../../src/protocol/link_platform.js";
import { Bench, ENGINE, type FakeBitmap, frameBytes, settled } from "./fakes.js";

const VIEW = {
  project: "main" as const,
  eyeEnu: [1, 2, 3] as Vec3,
  rotation: [1, 0, 0, 0] as Quat,
  fovyDeg: 45,
  orthoHeightM: null,
  w: 400,
  h: 250,
};
const RAY = { originEnu: [1, 2, 3] as Vec3, direction: [0, 0, -1] as Vec3, pixelPitch: 0.001, pixelWidthM: 0 };
const PICKED = { type: "picked", hit: true, point: [1, 2, 0], depth_m: 3, spread_m: 0.02, opacity: 0.99 };

function watch(bench: Bench): { frames: DecodedFrame<FakeBitmap>[]; states: LinkStatus[] } {
  const seen: { frames: DecodedFrame<FakeBitmap>[]; states: LinkStatus[] } = { frames: [], states: [] };
  bench.link.onFrame((frame) => seen.frames.push(frame));
  bench.link.onEngine((status) => seen.states.push(status));
  return seen;
}

test("says hello first, and the view only after the welcome", () => {
  const bench = new Bench();
  const { states } = watch(bench);
  assert.equal(bench.link.view(VIEW), 1);
  bench.socket.events.onOpen();
  assert.deepEqual(bench.socket.sent, [{ type: "hello", version: 1 }]);
  bench.welcome({ ranks: 2 });
  assert.equal(bench.sent("view").length, 1);
  assert.deepEqual(
    states.map(({ connected, ranks }) => [connected, ranks]),
    [
      [false, 1],
      [true, 2],
    ],
  );
});

test("frames are decoded, acknowledged and shown in order; older ones are closed unseen", async () => {
  const bench = new Bench();
  const { frames } = watch(bench);
  bench.welcome();
  const seq = bench.link.view(VIEW);
  bench.holdDecoding = true;
  bench.socket.events.onBytes(frameBytes({ seq, pass: 0 }));
  bench.socket.events.onBytes(frameBytes({ seq, pass: 1 }));
  await settled();
  assert.equal(bench.sent("ack").length, 0, "not before decoding");
  bench.held[1]?.();
  await settled();
  bench.held[0]?.();
  await settled();
  assert.deepEqual(
    frames.map(({ pass, width, depthM }) => [pass, width, depthM.length]),
    [[1, 5, 6]],
  );
  assert.deepEqual(
    bench.sent("ack").map(({ seq: s, pass }) => [s, pass]),
    [
      [seq, 1],
      [seq, 0],
    ],
  );
  assert.deepEqual(
    bench.bitmaps.map(({ frame, closed }) => [frame.header.pass, closed]),
    [
      [1, false],
      [0, true],
    ],
  );
  assert.equal(bench.link.statistics().droppedFrames, 1);
});

test("after stop, a newer view or another scene nothing of before is shown, but all is acknowledged", async () => {
  const bench = new Bench();
  const { frames } = watch(bench);
  bench.welcome();
  const first = bench.link.view(VIEW);
  const second = bench.link.viewPhoto(3, 400);
  bench.socket.events.onBytes(frameBytes({ seq: first }));
  bench.holdDecoding = true;
  bench.socket.events.onBytes(frameBytes({ seq: second }));
  bench.link.stop();
  assert.deepEqual(bench.sent("stop"), [{ type: "stop", seq: second }]);
  bench.held[0]?.();
  await settled();
  const third = bench.link.view(VIEW);
  bench.socket.events.onBytes(frameBytes({ seq: third, revision: 2 }));
  await settled();
  assert.equal(frames.length, 0);
  assert.ok(bench.bitmaps.every(({ closed }) => closed));
  assert.equal(bench.sent("ack").length, 3);
  assert.equal(bench.link.statistics().droppedFrames, 3);
});

test("a damaged frame is acknowledged and counted, and warned of once", async () => {
  const bench = new Bench();
  const { frames } = watch(bench);
  bench.welcome();
  const seq = bench.link.view(VIEW);
  bench.decodeFails = true;
  bench.socket.events.onBytes(frameBytes({ seq }));
  await settled();
  bench.decodeFails = false;
  bench.socket.events.onBytes(frameBytes({ seq, pass: 1, depth: [1, 2] }));
  await settled();
  bench.socket.events.onBytes(new ArrayBuffer(3));
  bench.text("{");
  bench.text({ type: "news" });
  bench.text({ type: "engine", engine: {} });
  assert.equal(frames.length, 0);
  assert.ok(bench.bitmaps.every(({ closed }) => closed));
  assert.equal(bench.sent("ack").length, 2);
  assert.equal(bench.link.statistics().badMessages, 6);
  assert.equal(bench.warnings.length, 1);
  assert.match(bench.warnings[0] ?? "", /damaged picture/);
});

test("connects again after 0.5, 1, 2, 4, 8, 8 s, and sends the resting view again", async () => {
  const bench = new Bench();
  const { states, frames } = watch(bench);
  bench.welcome();
  const seq = bench.link.view(VIEW);
  bench.socket.events.onBytes(frameBytes({ seq, pass: 2 }));
  await settled();
  for (const [i, wait] of [500, 1000, 2000, 4000, 8000, 8000].entries()) {
    bench.socket.events.onClose();
    const last = states[states.length - 1];
    assert.ok(last !== undefined && !last.connected && !last.ready && last.reason.startsWith(LOST));
    assert.equal(last.reason === LOST, i < 3, "later it says what else may be");
    bench.clock.advance(wait - 1);
    assert.equal(bench.sockets.length, i + 1);
    bench.clock.advance(1);
    assert.equal(bench.sockets.length, i + 2);
  }
  bench.welcome();
  assert.equal(bench.link.statistics().reconnects, 1);
  assert.deepEqual(
    bench.sent("view").map((view) => view.seq),
    [seq],
  );
  bench.socket.events.onBytes(frameBytes({ seq, pass: 0 }));
  await settled();
  assert.deepEqual(
    frames.map(({ pass }) => pass),
    [2, 0],
  );
  bench.socket.events.onClose();
  bench.clock.advance(500);
  assert.equal(bench.sockets.length, 8, "the wait begins anew after a welcome");
});

test("a moving camera has no view to send again", () => {
  const bench = new Bench();
  bench.welcome();
  bench.link.view(VIEW);
  bench.link.stop();
  bench.socket.events.onClose();
  bench.clock.advance(500);
  bench.welcome();
  assert.equal(bench.sent("view").length, 0);
});

test("a server that says nothing is left after 10 s; what it says then is not heard", () => {
  const bench = new Bench();
  const { states } = watch(bench);
  bench.socket.events.onOpen();
  bench.clock.advance(10_000);
  const old = bench.socket;
  assert.ok(old.closed);
  bench.clock.advance(500);
  assert.equal(bench.sockets.length, 2);
  old.events.onText(JSON.stringify({ type: "welcome", version: 1, client: 1, engine: {} }));
  old.events.onClose();
  assert.equal(bench.sockets.length, 2);
  assert.ok(states.every(({ connected }) => !connected));
  assert.equal(bench.link.statistics().badMessages, 0);
});

test("another version is told, not guessed", () => {
  const bench = new Bench();
  const { states } = watch(bench);
  bench.socket.events.onOpen();
  bench.text({ type: "welcome", version: 2, client: 1, engine: ENGINE });
  assert.match(states[states.length - 1]?.reason ?? "", /reload the page/);
});

test("answers go to their requests, errors too", async () => {
  const bench = new Bench();
  bench.welcome();
  const picked = bench.link.pick(RAY);
  const photos = bench.link.photosAt([1, 2, 3]);
  const volume = bench.link.volume(
    [
      [0, 0],
      [1, 0],
      [0, 1],
    ],
    "plane",
    0,
  );
  const [a, b, c] = bench.socket.sent.slice(1).map(({ id }) => id);
  bench.text({ type: "error", id: c, message: "the outline crosses itself" });
  bench.text({ type: "photos", id: b, checked: true, photos: [] });
  bench.text({ ...PICKED, id: a });
  assert.deepEqual(await picked, { hit: true, point: [1, 2, 0], depthM: 3, spreadM: 0.02, opacity: 0.99 });
  assert.deepEqual(await photos, { checked: true, photos: [] });
  await assert.rejects(volume, /crosses itself/);
});

test("an answer of another kind, or one that cannot be read, settles nothing wrongly", async () => {
  const bench = new Bench();
  bench.welcome();
  const picked = bench.link.pick(RAY);
  const id = bench.sent("pick")[0]?.id;
  bench.text({ type: "photos", id, checked: true, photos: [] });
  assert.equal(bench.link.statistics().badMessages, 1);
  bench.text({ ...PICKED, id, point: [1, 2] });
  await assert.rejects(picked, /point: 3 numbers expected/);
});

test("impossible requests and those without a connection reject at once", async () => {
  const bench = new Bench();
  await assert.rejects(bench.link.pick(RAY), /not connected yet/);
  bench.welcome();
  await assert.rejects(bench.link.profile([0, 0], [1, 1], 1), RangeError);
  bench.socket.events.onClose();
  await assert.rejects(bench.link.photosAt([0, 0, 0]), /is `skyquilt view` still running/);
  assert.equal(bench.sent("pick").length, 0);
});

test("a lost connection rejects what waits", async () => {
  const bench = new Bench();
  bench.welcome();
  const map = bench.link.errorMap();
  bench.socket.events.onClose();
  await assert.rejects(map, /is `skyquilt view` still running/);
});

test("progress is told from start to end, and lengthens the time limit", async () => {
  const bench = new Bench();
  const told: unknown[][] = [];
  bench.link.onProgress((...event) => told.push(event));
  bench.welcome();
  const map = bench.link.errorMap();
  const id = Number(bench.sent("error_map")[0]?.id);
  bench.clock.advance(599_000);
  bench.text({ type: "progress", id, fraction: 0.5 });
  bench.clock.advance(599_000);
  bench.text({
    type: "error_map",
    id,
    url: "pictures/1.png",
    min: [0, 0],
    max: [9, 9],
    scale: 0.1,
    photos: 2,
    of_photos: 3,
  });
  assert.equal((await map).url, "/data/pictures/1.png");
  assert.deepEqual(told, [
    [id, "Error map", null, false],
    [id, "Error map", 0.5, false],
    [id, "Error map", null, true],
  ]);
  assert.equal(bench.clock.waiting, 0, "no timer is left");
});

test("the map of the error to expect names no photos, and a refusal is told as it is", async () => {
  const bench = new Bench();
  bench.welcome();
  const [map, refused] = [bench.link.trustMap(), bench.link.trustMap()];
  const [a, b] = bench.sent("trust_map").map(({ id }) => Number(id));
  const answer = { type: "trust_map", id: a, url: "pictures/2.png", min: [-1, -2], max: [3, 4], scale: 0.25 };
  bench.text(answer);
  bench.text({ type: "error", id: b, message: "this project has no trust.h5" });
  assert.deepEqual(await map, { url: "/data/pictures/2.png", min: [-1, -2], max: [3, 4], scale: 0.25 });
  await assert.rejects(refused, /^Error: this project has no trust.h5$/);
  const unreadable = bench.link.trustMap();
  bench.text({ ...answer, id: bench.sent("trust_map")[2]?.id, url: "https://elsewhere/2.png" });
  await assert.rejects(unreadable, /url: a path below \/data\/ expected/);
});

test("without an answer a request ends, and the engine is told", async () => {
  const bench = new Bench();
  bench.welcome();
  const picked = bench.link.pick(RAY);
  const id = bench.sent("pick")[0]?.id;
  bench.clock.advance(30_000);
  await assert.rejects(picked, /did not answer within 30 s/);
  assert.deepEqual(bench.sent("cancel"), [{ type: "cancel", id }]);
  bench.text({ ...PICKED, id });
  assert.equal(bench.link.statistics().badMessages, 0, "a late answer is no mistake");
});

test("cancel ends the request with an AbortError", async () => {
  const bench = new Bench();
  let id = 0;
  bench.link.onProgress((started) => {
    id = started;
  });
  bench.welcome();
  const map = bench.link.errorMap();
  bench.link.cancel(id);
  await assert.rejects(map, isAbort);
  assert.deepEqual(bench.sent("cancel"), [{ type: "cancel", id }]);
});

test("of many picks two are under way and only the newest waits", async () => {
  const bench = new Bench();
  bench.welcome();
  const picks = [1, 2, 3, 4].map((x) => bench.link.pick({ ...RAY, originEnu: [x, 0, 0] }));
  await assert.rejects(picks[2] ?? Promise.resolve(), isAbort);
  for (const { id } of bench.sent("pick")) bench.text({ ...PICKED, id });
  await Promise.all([picks[0], picks[1]]);
  await settled();
  const sent = bench.sent("pick");
  assert.deepEqual(
    sent.map(({ origin }) => origin),
    [
      [1, 0, 0],
      [2, 0, 0],
      [4, 0, 0],
    ],
  );
  bench.text({ ...PICKED, id: sent[2]?.id });
  assert.ok((await picks[3])?.hit);
});

test("a view where the engine cannot follow is not sent, and the former one ends", () => {
  const bench = new Bench();
  bench.welcome();
  bench.link.view(VIEW);
  const seq = bench.link.view({ ...VIEW, eyeEnu: [0, 0, 1e9] });
  assert.equal(bench.sent("view").length, 1);
  assert.deepEqual(bench.sent("stop"), [{ type: "stop", seq }]);
});

test("close ends all", async () => {
  const bench = new Bench();
  const { frames } = watch(bench);
  bench.welcome();
  const seq = bench.link.view(VIEW);
  const map = assert.rejects(bench.link.errorMap(), isAbort);
  bench.holdDecoding = true;
  bench.socket.events.onBytes(frameBytes({ seq }));
  bench.link.close();
  bench.held[0]?.();
  await settled();
  await map;
  await assert.rejects(bench.link.pick(RAY), isAbort);
  assert.ok(bench.socket.closed && bench.bitmaps[0]?.closed);
  bench.socket.events.onClose();
  bench.clock.advance(60_000);
  assert.equal(bench.sockets.length, 1);
  assert.equal(frames.length, 0);
});
