import assert from "node:assert/strict";
import { test } from "node:test";
import { ManualClock } from "../../../src/base/clock.js";
import type { Which } from "../../../src/protocol/link_api.js";
import { ViewRequests } from "../../../src/scene/view_requests.js";

function setUp() {
  const clock = new ManualClock();
  const log: string[] = [];
  const world = { allowed: true, sides: ["main"] as Which[], seq: 0, progress: [] as string[] };
  const requests = new ViewRequests({
    clock,
    ask: (side) => {
      world.seq += 1;
      log.push(`${side} ${world.seq} at ${clock.nowMs()}`);
      return world.seq;
    },
    stop: () => log.push(`stop at ${clock.nowMs()}`),
    sides: () => world.sides,
    allowed: () => world.allowed,
    onRest: () => {},
    onProgress: (pass, passes) => world.progress.push(`${pass}/${passes}`),
  });
  const frame = (seq: number, pass: number, project: Which = "main") =>
    requests.accept({ seq, pass, passes: 3, project });
  return { clock, log, world, requests, frame };
}

test("a view is asked for 120 ms after the last move, once", () => {
  const { clock, log, requests } = setUp();
  requests.moved();
  clock.advance(100);
  requests.moved();
  clock.advance(119);
  assert.deepEqual(log, []);
  assert.equal(requests.resting, false);
  clock.advance(1);
  assert.deepEqual(log, ["main 1 at 220"]);
  assert.equal(requests.resting, true);
  clock.advance(1000);
  assert.equal(log.length, 1);
});

test("a move stops what is under way, and nothing when all has come", () => {
  const { clock, log, requests, frame } = setUp();
  requests.moved();
  clock.advance(120);
  requests.moved();
  requests.moved();
  assert.deepEqual(log, ["main 1 at 120", "stop at 120"]);
  clock.advance(120);
  for (const pass of [0, 1, 2]) assert.equal(frame(2, pass), true);
  requests.moved();
  assert.deepEqual(log, ["main 1 at 120", "stop at 120", "main 2 at 240"]);
});

test("frames of other views, older passes and the other side are refused", () => {
  const { clock, requests, frame, world } = setUp();
  requests.moved();
  assert.equal(frame(1, 0), false);
  clock.advance(120);
  assert.equal(frame(7, 0), false);
  assert.equal(frame(1, 0, "before"), false);
  assert.equal(frame(1, 1), true);
  assert.equal(frame(1, 0), false);
  assert.equal(frame(1, 1), false);
  assert.equal(frame(1, 2), true);
  assert.equal(frame(1, 2), false);
  assert.deepEqual(world.progress, ["-1/3", "1/3", "2/3"]);
  requests.moved();
  assert.equal(world.progress[3], "-1/3");
});

test("the earlier project is asked for when the main one is complete", () => {
  const { clock, log, world, requests, frame } = setUp();
  world.sides = ["main", "before"];
  requests.moved();
  clock.advance(120);
  for (const pass of [0, 1]) frame(1, pass);
  assert.equal(log.length, 1);
  frame(1, 2);
  assert.deepEqual(log, ["main 1 at 120", "before 2 at 120"]);
  for (const pass of [0, 1, 2]) assert.equal(frame(2, pass, "before"), true);
  assert.equal(world.progress[world.progress.length - 1], "5/6");
  assert.equal(log.length, 2);
});

test("the swipe switched on at rest asks only for what is missing; switched off it stops that", () => {
  const { clock, log, world, requests, frame } = setUp();
  requests.moved();
  clock.advance(120);
  for (const pass of [0, 1, 2]) frame(1, pass);
  world.sides = ["main", "before"];
  requests.refresh();
  assert.deepEqual(log, ["main 1 at 120", "before 2 at 120"]);
  world.sides = ["main"];
  requests.refresh();
  assert.deepEqual(log[2], "stop at 120");
  assert.equal(frame(2, 0, "before"), false);
});

test("nothing is asked for while it is not allowed; what was given up comes later", () => {
  const { clock, log, world, requests, frame } = setUp();
  world.allowed = false;
  requests.moved();
  clock.advance(500);
  assert.deepEqual(log, []);
  world.allowed = true;
  requests.refresh();
  assert.deepEqual(log, ["main 1 at 500"]);
  world.allowed = false;
  requests.refresh();
  assert.deepEqual(log[1], "stop at 500");
  assert.equal(frame(1, 0), false);
  world.allowed = true;
  requests.refresh();
  assert.deepEqual(log[2], "main 2 at 500");
});

test("after its end no timer is left", () => {
  const { clock, log, requests } = setUp();
  requests.moved();
  requests.dispose();
  assert.equal(clock.waiting, 0);
  clock.advance(500);
  assert.deepEqual(log, []);
});
