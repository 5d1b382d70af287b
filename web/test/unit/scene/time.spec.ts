import assert from "node:assert/strict";
import { test } from "node:test";
import { ManualClock } from "../../../src/base/clock.js";
import { FADE_MS, Fade } from "../../../src/scene/fade.js";
import { FrameMeter } from "../../../src/scene/quality.js";
import { ReadoutWriter } from "../../../src/scene/readout.js";
import { initialState } from "../../../src/state/initial.js";
import { Store } from "../../../src/state/store.js";
import { sampleProject } from "./samples.js";

test("a fade takes 150 ms from its first step, turns round where it is, and may jump", () => {
  const fade = new Fade();
  assert.ok(fade.gone);
  fade.to(1, false);
  fade.step(1000);
  assert.equal(fade.opacity, 0);
  fade.step(1000 + FADE_MS / 2);
  assert.ok(Math.abs(fade.opacity - 0.5) < 1e-9 && fade.active);
  fade.to(0, false);
  fade.step(1000 + FADE_MS / 2 + 15);
  assert.ok(fade.opacity < 0.5 && fade.opacity > 0.3);
  fade.step(3000);
  assert.ok(fade.gone && !fade.active);
  fade.to(1, true);
  assert.equal(fade.opacity, 1);
  assert.equal(fade.active, false);
  // A fade that begins after a long pause begins at its beginning.
  fade.to(0, false);
  fade.step(90_000);
  assert.equal(fade.opacity, 1);
});

function run(meter: FrameMeter, from: number, gapMs: number, frames: number): number {
  for (let i = 0; i < frames; i += 1) meter.frame(from + i * gapMs, true);
  return from + frames * gapMs;
}

test("frames per second count only while something moves", () => {
  const meter = new FrameMeter();
  let now = run(meter, 0, 20, 60);
  assert.ok(Math.abs(meter.fps - 50) < 0.5, `${meter.fps}`);
  meter.frame(now, false);
  now = run(meter, now + 60_000, 25, 60);
  assert.ok(Math.abs(meter.fps - 40) < 0.5, `${meter.fps}`);
});

test("slow motion gives up quality, rest never does, and fast motion gets it back later", () => {
  const meter = new FrameMeter();
  const full = meter.quality(false);
  assert.deepEqual(meter.quality(true), full);
  let now = run(meter, 0, 60, 12);
  assert.notDeepEqual(meter.quality(true), full);
  assert.deepEqual(meter.quality(false), full);
  now = run(meter, now, 60, 100);
  const least = meter.quality(true);
  assert.ok(least.errorTarget > full.errorTarget);
  now = run(meter, now, 16, 200);
  assert.deepEqual(meter.quality(true), least, "raised too early");
  now = run(meter, now, 16, 3000);
  assert.deepEqual(meter.quality(true), full);
  assert.equal(new FrameMeter(true).quality(true).coarse, true);
  assert.equal(new FrameMeter(true).quality(false).coarse, false);
});

test("a hidden window is not a slow one", () => {
  const meter = new FrameMeter();
  for (let i = 0; i < 40; i += 1) meter.frame(i * 2000, true);
  assert.deepEqual(meter.quality(true), meter.quality(false));
});

test("read-outs are written at most ten times a second, the last one always, the cursor kept", () => {
  const clock = new ManualClock();
  const store = new Store(initialState(sampleProject()));
  let heading = 0;
  const writer = new ReadoutWriter(store, clock, () => ({
    metresPerPx: 0.5,
    headingDeg: heading,
    pitchDeg: -30,
    fps: 60,
  }));
  let writes = 0;
  store.subscribe(
    (state) => state.readout,
    () => {
      writes += 1;
    },
  );
  for (let i = 0; i < 50; i += 1) {
    heading = i;
    writer.changed();
    clock.advance(10);
  }
  assert.ok(writes >= 5 && writes <= 6, `${writes}`);
  clock.advance(200);
  assert.equal(store.get().readout.headingDeg, 49);
  assert.equal(store.get().readout.cursor, null);
  const before = writes;
  writer.changed();
  clock.advance(200);
  assert.equal(writes, before, "the same value was written again");
  writer.changed();
  writer.dispose();
  assert.equal(clock.waiting, 0);
});
