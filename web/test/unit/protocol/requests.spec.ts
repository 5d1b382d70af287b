import assert from "node:assert/strict";
import test from "node:test";
import { isAbort } from "../../../src/base/abort.js";
import { FrameOrder } from "../../../src/protocol/frame_order.js";
import { NewestWins } from "../../../src/protocol/requests.js";
import { settled } from "./fakes.js";

test("two at a time, of those that wait only the newest", async () => {
  const ends: ((value: number) => void)[] = [];
  const started: number[] = [];
  const queue = new NewestWins<number>(2);
  const start = (name: number) =>
    queue.start(() => {
      started.push(name);
      return new Promise<number>((resolve) => ends.push(resolve));
    });
  const first = start(1);
  const second = start(2);
  const third = start(3);
  const fourth = start(4);
  await assert.rejects(third, isAbort);
  assert.deepEqual(started, [1, 2]);
  ends[0]?.(10);
  assert.equal(await first, 10);
  await settled();
  assert.deepEqual(started, [1, 2, 4]);
  ends[1]?.(20);
  ends[2]?.(40);
  assert.deepEqual(await Promise.all([second, fourth]), [20, 40]);
});

test("one that fails makes room for the next", async () => {
  const queue = new NewestWins<number>(1);
  const first = queue.start(() => Promise.reject(new Error("no")));
  const second = queue.start(() => Promise.resolve(2));
  await assert.rejects(first, /no/);
  assert.equal(await second, 2);
});

test("frames go forwards only, by view and pass", () => {
  const order = new FrameOrder();
  const frame = (seq: number, pass: number, revision = 1) => ({ seq, pass, revision });
  order.setRevision(1);
  order.wantFrom(5);
  assert.ok(!order.wanted(frame(4, 2)), "an older view");
  assert.ok(order.wanted(frame(5, 1)));
  order.shown(frame(5, 1));
  assert.ok(!order.wanted(frame(5, 1)) && !order.wanted(frame(5, 0)), "the same pass or an earlier one");
  assert.ok(order.wanted(frame(5, 2)));
  assert.ok(!order.wanted(frame(5, 2, 2)), "another scene");
  order.setRevision(2);
  assert.ok(order.wanted(frame(5, 0, 2)), "the new scene begins with its first pass");
  assert.ok(!order.wanted(frame(4, 0, 2)));
  order.restart();
  assert.ok(order.wanted(frame(5, 0, 9)), "another connection");
});
