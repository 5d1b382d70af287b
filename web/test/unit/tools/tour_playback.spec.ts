import assert from "node:assert/strict";
import test from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import type { CameraPose } from "../../../src/state/app_state.js";
import { type Ground, TourPlayback } from "../../../src/tools/tour_playback.js";
import { changeStop } from "../../../src/tour/edit_stops.js";
import type { Tour } from "../../../src/tour/types.js";
import { terrainOf } from "../tour/terrains.js";
import { type Bench, bench, settle } from "./fakes.js";
import { openTour, rowOfStops } from "./tour_samples.js";

interface Stage extends Bench {
  readonly playback: TourPlayback;
  readonly poses: CameraPose[];
  /** The person has moved the camera there. */
  move(eyeEnu: Vec3): void;
  /** Frames of 16 ms until nothing moves or so many have passed. */
  frames(most?: number): Promise<number>;
}

function stage(tour: Tour, reduced = false): Stage {
  const b = bench();
  openTour(b.store, tour);
  const poses: CameraPose[] = [];
  let waiting: (() => void) | null = null;
  const scene = {
    ...b.scene,
    flyTo: (pose: CameraPose) => {
      poses.push(pose);
      b.pose = pose;
      return Promise.resolve();
    },
  };
  const playback = new TourPlayback({
    store: b.store,
    scene,
    clock: b.clock,
    nextFrame: (draw) => {
      waiting = draw;
      return () => {
        if (waiting === draw) waiting = null;
      };
    },
    ground: () => Promise.resolve({ heights: null, map: null }),
    reducedMotion: () => reduced,
  });
  const frames = async (most = 2000) => {
    await settle();
    let count = 0;
    for (; waiting !== null && count < most; count += 1) {
      const draw: () => void = waiting;
      waiting = null;
      b.clock.advance(16);
      draw();
    }
    await settle();
    return count;
  };
  const move = (eyeEnu: Vec3) => {
    b.pose = { ...b.pose, eyeEnu };
  };
  return Object.assign(b, { playback, poses, frames, move });
}

const at = ({ store }: Bench) => `${store.get().play?.stop?.id} ${store.get().play?.phase}`;
const eyes = (s: Stage) => s.poses.map(({ eyeEnu }) => eyeEnu[0]);
/** The readout tells that the camera has moved, as the scene does. */
function tellMoved({ store }: Bench): void {
  store.update(({ readout }) => ({ readout: { ...readout } }));
}

test("it begins at the start, goes to the next without a cut, and back", async () => {
  const s = stage(rowOfStops());
  s.playback.play();
  assert.equal(at(s), "stop-1 stop");
  assert.equal(s.store.get().play?.can.previous, false);
  s.playback.next();
  assert.equal(at(s), "stop-2 moving");
  const count = await s.frames();
  assert.ok(count > 50, `${count} frames`);
  assert.equal(at(s), "stop-2 stop");
  const steps = eyes(s).map((x, i, all) => Math.abs(x - (all[i - 1] ?? x)));
  assert.ok(Math.max(...steps) < 0.5, `a step of ${Math.max(...steps)} m`);
  assert.deepEqual(s.poses.at(-1)?.eyeEnu, [10, 0, 5]);
  assert.deepEqual(s.store.get().play?.seen, ["stop-1", "stop-2"]);
  s.playback.previous();
  await s.frames();
  assert.equal(at(s), "stop-1 stop");
});

test("how far one is, is told a few times a second, not with every frame", async () => {
  const s = stage(rowOfStops());
  s.playback.play();
  let told = 0;
  s.store.subscribe(
    ({ play }) => play,
    () => {
      told += 1;
    },
  );
  s.playback.next();
  const count = await s.frames();
  assert.ok(told > 5 && told < count / 4, `${told} times in ${count} frames`);
});

test("where motion is to be reduced every way is a cut", async () => {
  const s = stage(rowOfStops(), true);
  s.playback.play();
  s.playback.next();
  assert.equal(await s.frames(), 0);
  assert.equal(at(s), "stop-2 stop");
  assert.deepEqual(eyes(s), [0, 10]);
});

test("autoplay stays as long as the stop says, goes on, and ends at the end", async () => {
  const s = stage(
    changeStop(rowOfStops({ pauseS: 4 }), "stop-2", { pauseS: 2, next: { to: null, path: { kind: "jump" } } }),
  );
  s.playback.play();
  s.playback.resume();
  s.clock.advance(3800);
  assert.equal(at(s), "stop-1 stop");
  assert.ok((s.store.get().play?.progress.share ?? 0) > 0.9);
  s.clock.advance(300);
  await s.frames();
  assert.equal(at(s), "stop-2 stop");
  s.clock.advance(2100);
  assert.equal(at(s), "stop-3 stop");
  s.clock.advance(60_000);
  assert.equal(s.store.get().play?.playing, false);
  assert.equal(s.clock.waiting, 0);
});

test("a page that slept goes on from where it was", async () => {
  const s = stage(rowOfStops());
  s.playback.play();
  s.playback.next();
  await s.frames(10);
  const [before] = s.pose.eyeEnu;
  s.clock.advance(60_000);
  await s.frames(1);
  assert.equal(at(s), "stop-2 moving");
  assert.ok((s.poses.at(-1)?.eyeEnu[0] ?? 0) - before < 5);
});

test("a hand on the view breaks the way off; the next step begins from where the person has moved", async () => {
  const s = stage(rowOfStops());
  s.playback.play();
  s.playback.next();
  await s.frames(40);
  s.canvas.dispatchEvent(new Event("pointerdown"));
  assert.equal(at(s), "stop-2 look");
  assert.equal(await s.frames(), 0);
  s.move([4, 3, 5]);
  s.playback.next();
  await s.frames(1);
  const [x, y] = s.poses.at(-1)?.eyeEnu ?? [0, 0];
  assert.ok(Math.abs(x - 4) < 0.5 && Math.abs(y - 3) < 0.5, `from ${x} ${y}`);
  await s.frames();
  assert.equal(at(s), "stop-2 stop");
});

test("at a stop a touch alone changes nothing; who has moved the view can go back to it, and autoplay waits", async () => {
  const s = stage(rowOfStops());
  s.playback.play();
  s.playback.resume();
  s.canvas.dispatchEvent(new Event("pointerdown"));
  tellMoved(s);
  assert.equal(at(s), "stop-1 stop");
  s.move([0, 1, 5]);
  tellMoved(s);
  assert.equal(at(s), "stop-1 look");
  assert.deepEqual([s.store.get().play?.playing, s.store.get().play?.arrived], [false, true]);
  s.clock.advance(60_000);
  assert.equal(at(s), "stop-1 look");
  s.playback.back();
  await s.frames();
  assert.equal(at(s), "stop-1 stop");
  assert.deepEqual(s.poses.at(-1)?.eyeEnu, [0, 0, 5]);
});

test("from a look around one comes back also where every way is a cut", async () => {
  const s = stage(rowOfStops(), true);
  s.playback.play();
  assert.equal(s.store.get().navigation, "fly");
  s.move([0, 1, 5]);
  tellMoved(s);
  assert.equal(at(s), "stop-1 look");
  s.playback.back();
  await s.frames();
  assert.equal(at(s), "stop-1 stop");
  assert.deepEqual(s.pose.eyeEnu, [0, 0, 5]);
});

test("a stop's layers, brightness and measurements hold there, and all is as before at the end", async () => {
  const tour = changeStop(rowOfStops(), "stop-2", {
    layers: { points: true, surface: false },
    exposureStops: 1.5,
    measurements: ["m2"],
  });
  const s = stage(tour);
  s.store.update(({ layers }) => ({ layers: { ...layers, contours: true, measurements: true }, panel: "measure" }));
  const before = s.store.get();
  s.playback.play();
  assert.equal(s.store.get().layers.contours, true);
  assert.deepEqual(s.store.get().shownMeasurements, []);
  s.playback.next();
  await s.frames();
  const there = s.store.get();
  assert.deepEqual(
    [there.layers.points, there.layers.surface, there.layers.contours, there.layers.measurements],
    [true, false, true, true],
  );
  assert.equal(there.exposureStops, 1.5);
  assert.deepEqual(there.shownMeasurements, ["m2"]);
  s.playback.next();
  await s.frames();
  assert.equal(s.store.get().layers.surface, true);
  assert.equal(s.store.get().exposureStops, 0);
  s.playback.leave();
  const { layers, exposureStops, shownMeasurements, panel, play, navigation } = s.store.get();
  assert.deepEqual(layers, before.layers);
  assert.deepEqual(
    { exposureStops, shownMeasurements, panel, play, navigation },
    { exposureStops: 0, shownMeasurements: null, panel: "measure", play: null, navigation: before.navigation },
  );
});

test("a stop that shows the held-out error takes the place of the error to expect", () => {
  const s = stage(changeStop(rowOfStops(), "stop-1", { layers: { errorMap: true } }));
  s.store.update(({ layers }) => ({ layers: { ...layers, trust: true } }));
  s.playback.play();
  const maps = () => [s.store.get().layers.errorMap, s.store.get().layers.trust];
  assert.deepEqual(maps(), [true, false]);
  s.playback.leave();
  assert.deepEqual(maps(), [false, true]);
});

test("leaving on the way ends the motion, and an empty tour does not begin", async () => {
  const s = stage(rowOfStops());
  s.playback.play();
  s.playback.next();
  await s.frames(5);
  s.playback.leave();
  const { length } = s.poses;
  assert.equal(await s.frames(), 0);
  s.clock.advance(10_000);
  s.canvas.dispatchEvent(new Event("pointerdown"));
  assert.equal(s.poses.length, length);
  const none = stage({ ...rowOfStops(), stops: [] });
  none.playback.play();
  assert.equal(none.store.get().play, null);
});

test("the ground is asked for once, and a tour plays without it", async () => {
  const s = stage(rowOfStops());
  let asked = 0;
  const playback = new TourPlayback({
    store: s.store,
    scene: s.scene,
    clock: s.clock,
    nextFrame: () => () => {},
    ground: () => {
      asked += 1;
      return Promise.reject(new Error("no surface model"));
    },
    reducedMotion: () => false,
  });
  playback.play();
  playback.next();
  await settle();
  playback.play();
  await settle();
  assert.equal(asked, 1);
  assert.equal(s.store.get().play?.stop?.id, "stop-1");
});

test("a way that began before the ground was known is planned anew when it is", async () => {
  const s = stage(rowOfStops());
  let come = (_: Ground): void => {};
  let waiting = (): void => {};
  const playback = new TourPlayback({
    store: s.store,
    scene: { ...s.scene, flyTo: (pose) => Promise.resolve(void s.poses.push(pose)) },
    clock: s.clock,
    nextFrame: (draw) => {
      waiting = draw;
      return () => {
        waiting = () => {};
      };
    },
    ground: () =>
      new Promise((resolve) => {
        come = resolve;
      }),
    reducedMotion: () => false,
  });
  playback.play();
  playback.next();
  const wall = terrainOf(30, 20, (column) => (column === 15 ? 20 : 0), [1, 1], [-10, -10]);
  come({ heights: wall.heights, map: null });
  await settle();
  for (let frame = 0; frame < 2000; frame += 1) {
    s.clock.advance(16);
    waiting();
  }
  assert.equal(at(s), "stop-2 stop");
  assert.ok(Math.max(...s.poses.map(({ eyeEnu }) => eyeEnu[2])) > 20.9);
});
