import assert from "node:assert/strict";
import test from "node:test";
import { norm, sub } from "../../../src/base/vec_math.js";
import { anglesOfPose } from "../../../src/geo/camera.js";
import { changeStop, setNext } from "../../../src/tour/edit_stops.js";
import { TourPlayer } from "../../../src/tour/player.js";
import type { PlayerView } from "../../../src/tour/player_view.js";
import { EMPTY_TOUR, stopOf, type Tour } from "../../../src/tour/types.js";
import { sampleTour } from "./samples.js";
import { terrainOf } from "./terrains.js";

/** The same with time to look at b, where autoplay of the sample goes on at once. */
function calmTour(): Tour {
  return changeStop(sampleTour(), "b", { pauseS: 4 });
}

/** A player with a clock of its own. The tour: a, then b (where it begins), then c, the end; a and c have branches to each other. */
class Show {
  now = 100;
  reduced = false;
  readonly player: TourPlayer;

  constructor(tour: Tour = sampleTour(), at?: string) {
    const options = { tour, heights: () => null, reducedMotion: () => this.reduced };
    this.player = new TourPlayer(at === undefined ? options : { ...options, at }, this.now);
  }

  after(seconds: number): PlayerView {
    this.now += seconds;
    return this.player.view(this.now);
  }

  get view(): PlayerView {
    return this.player.view(this.now);
  }

  /** In steps, as frames do, until it is at rest; how long it took. */
  arrive(): number {
    const began = this.now;
    for (let frame = 0; frame < 3000; frame += 1) {
      const { phase } = this.after(0.02);
      if (phase !== "moving") return this.now - began;
    }
    throw new Error("it never arrives");
  }

  at(id: string, phase: PlayerView["phase"] = "stop"): void {
    assert.deepEqual([this.view.stop?.id, this.view.phase], [id, phase]);
  }
}

function distance(a: PlayerView, b: PlayerView): number {
  return a.pose === null || b.pose === null ? Number.NaN : norm(sub(a.pose.eyeEnu, b.pose.eyeEnu));
}

test("it begins at the start, at the first stop, or where it is told", () => {
  const tour = sampleTour();
  new Show(tour).at("b");
  new Show({ ...tour, start: null }).at("a");
  new Show(tour, "c").at("c");
  new Show(tour, "nowhere").at("b");
  const { view } = new Show(tour);
  assert.deepEqual(view.pose, { ...stopOf(tour, "b")?.pose, orthoHeightM: null });
  assert.deepEqual(
    [view.arrived, view.playing, view.ended, view.progress.index, view.progress.count],
    [true, false, false, 1, 3],
  );
  assert.deepEqual(view.can, { next: true, previous: false, play: true, pause: false, back: false, branches: [] });
});

test("an empty tour shows what is always shown, and nothing can be done", () => {
  const show = new Show({ ...EMPTY_TOUR, things: sampleTour().things });
  for (const act of ["next", "previous", "play", "pause", "back"] as const) show.player[act](show.now);
  show.player.look(5, 5, show.now);
  show.player.goTo("a", show.now);
  show.player.branch(0, show.now);
  const { view } = show;
  assert.deepEqual([view.phase, view.pose, view.stop, view.progress.count], ["empty", null, null, 0]);
  assert.deepEqual(
    view.things.map(({ id }) => id),
    ["l"],
  );
  assert.ok(!view.can.next && !view.can.previous && !view.can.play && !view.can.pause && !view.can.back);
});

test("next goes on to the last stop, previous back to where one came from", () => {
  const show = new Show(sampleTour(), "a");
  show.player.next(show.now);
  show.at("b", "moving");
  assert.equal(show.view.arrived, false);
  show.arrive();
  show.at("b");
  show.player.next(show.now);
  show.arrive();
  show.at("c");
  assert.deepEqual([show.view.ended, show.view.can.next, show.view.can.previous], [true, false, true]);
  show.player.next(show.now);
  show.at("c");
  show.player.previous(show.now);
  show.at("b", "moving");
  show.arrive();
  show.player.previous(show.now);
  show.arrive();
  show.at("a");
  assert.equal(show.view.can.previous, false);
  show.player.previous(show.now);
  show.at("a");
});

test("on the way the camera moves from pose to pose without a jump, and progress tells how far", () => {
  const show = new Show(sampleTour(), "a");
  const first = show.view;
  show.player.next(show.now);
  let [before, share] = [show.view, 0];
  assert.ok(distance(first, before) < 1e-9);
  for (let frame = 0; frame < 2000 && show.view.phase === "moving"; frame += 1) {
    const now = show.after(0.01);
    assert.ok(distance(before, now) < 0.2 && now.progress.share >= share);
    [before, share] = [now, now.phase === "moving" ? now.progress.share : 0];
  }
  assert.deepEqual(before.pose?.eyeEnu, stopOf(sampleTour(), "b")?.pose.eyeEnu);
});

test("branches and hot spots lead elsewhere, and back again", () => {
  const show = new Show(sampleTour(), "a");
  assert.deepEqual(
    show.view.can.branches.map(({ label, to }) => [label, to.id]),
    [["Up the tower", "c"]],
  );
  show.player.branch(1, show.now);
  show.at("a");
  show.player.branch(0, show.now);
  show.at("c", "moving");
  assert.deepEqual(show.view.can.branches, []);
  show.arrive();
  // The branch back is a cut.
  show.player.branch(0, show.now);
  show.at("a");
  assert.equal(show.view.cuts, 1);
  show.player.goTo("b", show.now);
  show.arrive();
  for (const id of ["a", "c", "a"]) {
    show.player.previous(show.now);
    show.arrive();
    show.at(id);
  }
  assert.equal(show.view.can.previous, false);
  for (const id of ["nowhere", "a"]) {
    show.player.goTo(id, show.now);
    show.at("a");
  }
});

test("things are shown at their stops, on the way also those of the stop that was left", () => {
  const ids = (view: PlayerView) => view.things.map(({ id }) => id).join("");
  const show = new Show();
  assert.equal(ids(show.view), "lm");
  show.player.next(show.now);
  assert.equal(ids(show.view), "lmh");
  show.arrive();
  assert.equal(ids(show.view), "lh");
});

test("autoplay stays as long as each stop says, and stops at the end", () => {
  let tour = changeStop(sampleTour(), "b", { pauseS: 2 });
  tour = changeStop(tour, "c", { pauseS: 3 });
  const show = new Show(tour, "a");
  assert.equal(show.after(1000).phase, "stop");
  show.player.play(show.now);
  assert.deepEqual([show.view.playing, show.view.can.play, show.view.can.pause], [true, false, true]);
  assert.equal(show.after(2.9).phase, "stop");
  assert.ok(Math.abs(show.view.progress.share - 2.9 / 3) < 1e-9);
  assert.equal(show.after(0.2).phase, "moving");
  show.arrive();
  show.at("b");
  assert.equal(show.after(1.9).phase, "stop");
  assert.equal(show.after(0.2).phase, "moving");
  show.arrive();
  show.at("c");
  assert.ok(show.after(2.9).playing);
  const end = show.after(0.2);
  assert.deepEqual([end.playing, end.ended, end.can.play], [false, true, true]);
  show.at("c");
  // Play begins again.
  show.player.play(show.now);
  show.at("b", "moving");
  show.arrive();
  assert.ok(show.view.playing);
});

test("pause halts autoplay at a stop, and play waits the whole pause again", () => {
  const show = new Show(sampleTour(), "a");
  show.player.play(show.now);
  show.after(2);
  show.player.pause(show.now);
  assert.deepEqual([show.after(100).phase, show.view.playing], ["stop", false]);
  show.player.play(show.now);
  assert.equal(show.after(2.9).phase, "stop");
  assert.equal(show.after(0.2).phase, "moving");
});

test("pause halts a way where it is; play, next and back go on with the same way", () => {
  for (const act of ["play", "next", "back"] as const) {
    const show = new Show(calmTour(), "a");
    show.player.next(show.now);
    const half = show.after(1.5);
    show.player.pause(show.now);
    const halted = show.after(60);
    assert.deepEqual(
      [halted.phase, halted.can.play, halted.can.pause, halted.can.back, halted.can.next],
      ["paused", true, false, true, true],
    );
    assert.ok(distance(half, halted) < 1e-12);
    assert.ok(Math.abs(half.progress.share - halted.progress.share) < 1e-12);
    show.player[act](show.now);
    show.at("b", "moving");
    assert.ok(distance(half, show.view) < 1e-12);
    assert.equal(show.view.playing, act === "play");
    show.arrive();
    show.at("b", "stop");
  }
  // Autoplay that was halted on the way is on again.
  const show = new Show(calmTour(), "a");
  show.player.play(show.now);
  show.after(3.1);
  show.player.pause(show.after(1) && show.now);
  assert.equal(show.view.playing, false);
  show.player.back(show.now);
  assert.ok(show.view.playing);
});

test("looking around turns the view only, ends autoplay, and goes back when asked", () => {
  const show = new Show();
  show.player.play(show.now);
  show.player.look(30, 20, show.now);
  show.at("b", "look");
  const { pose, playing, arrived, can } = show.view;
  assert.ok(pose);
  assert.deepEqual([playing, arrived, can.back, can.next], [false, true, true, true]);
  const angles = anglesOfPose(pose.rotation);
  assert.ok(Math.abs(angles.yawDeg - 120) < 1e-9 && Math.abs(angles.pitchDeg - 20) < 1e-9);
  assert.deepEqual(pose.eyeEnu, [20, 0, 10]);
  show.player.look(-400, 500, show.now);
  const high = anglesOfPose(show.view.pose?.rotation ?? [1, 0, 0, 0]);
  assert.ok(Math.abs(high.pitchDeg - 89) < 1e-6 && Math.abs(high.yawDeg - 80) < 1e-6);
  show.player.look(0, -500, show.now);
  assert.ok(Math.abs(anglesOfPose(show.view.pose?.rotation ?? [1, 0, 0, 0]).pitchDeg + 90) < 1e-6);
  show.player.look(Number.NaN, 0, show.now);
  assert.ok(show.view.pose?.rotation.every(Number.isFinite));
  assert.equal(show.after(1000).phase, "look");
  show.player.back(show.now);
  show.at("b", "moving");
  assert.equal(show.view.arrived, true);
  show.arrive();
  show.at("b");
  assert.deepEqual(show.view.pose, { ...stopOf(sampleTour(), "b")?.pose, orthoHeightM: null });
  show.player.back(show.now);
  show.at("b");
});

test("from anywhere one looks, next, previous, branches, play and the stop itself are there", () => {
  const seen = (id: string) => {
    const show = new Show(sampleTour(), id);
    show.player.look(90, 0, show.now);
    return show;
  };
  let show = seen("a");
  const turned = show.view;
  show.player.next(show.now);
  show.at("b", "moving");
  assert.ok(distance(turned, show.view) < 1e-9);
  show.arrive();
  show.player.previous(show.now);
  show.arrive();
  show.at("a");
  show = seen("a");
  show.player.branch(0, show.now);
  show.at("c", "moving");
  show = seen("a");
  show.player.goTo("a", show.now);
  show.at("a", "moving");
  assert.ok(show.view.arrived);
  show = seen("a");
  show.player.play(show.now);
  show.arrive();
  show.at("a");
  assert.equal(show.after(3.1).stop?.id, "b");
});

test("a person may move away from a stop and comes back", () => {
  const show = new Show();
  const { pose } = show.view;
  assert.ok(pose);
  show.player.movedTo({ ...pose, eyeEnu: [25, 5, 12] }, show.now);
  show.at("b", "look");
  assert.deepEqual(show.view.pose?.eyeEnu, [25, 5, 12]);
  show.player.back(show.now);
  assert.ok(show.arrive() > 1);
  assert.deepEqual(show.view.pose?.eyeEnu, [20, 0, 10]);
});

test("a way that is broken off goes on to its stop, or back to where it began", () => {
  const broken = () => {
    const show = new Show(calmTour(), "a");
    show.player.next(show.now);
    show.after(2);
    show.player.look(10, 0, show.now);
    show.at("b", "look");
    return show;
  };
  let show = broken();
  const { arrived, can, pose, things } = show.view;
  assert.deepEqual([arrived, can.next, can.previous, can.back, can.branches.length], [false, true, true, true, 0]);
  assert.ok(pose && pose.eyeEnu[0] > 1 && pose.eyeEnu[0] < 19);
  assert.deepEqual(
    things.map(({ id }) => id),
    ["l", "m"],
  );
  for (const act of ["next", "back", "play"] as const) {
    show = broken();
    show.player[act](show.now);
    show.at("b", "moving");
    show.arrive();
    show.at("b");
    show.player.previous(show.now);
    show.arrive();
    show.at("a");
  }
  show = broken();
  show.player.previous(show.now);
  show.arrive();
  show.at("a");
  assert.equal(show.view.can.previous, false);
  show = broken();
  show.player.goTo("a", show.now);
  show.arrive();
  show.at("a");
  assert.equal(show.view.can.previous, false);
});

test("on the way, next skips the stop ahead and previous turns round, both from where one is", () => {
  const show = new Show(sampleTour(), "a");
  show.player.next(show.now);
  const half = show.after(2);
  show.player.next(show.now);
  show.at("c", "moving");
  assert.ok(distance(half, show.view) < 1e-9);
  show.arrive();
  show.player.previous(show.now);
  show.arrive();
  show.at("a");
  show.player.next(show.now);
  show.after(2);
  show.player.previous(show.now);
  show.at("a", "moving");
  show.arrive();
  assert.deepEqual([show.view.stop?.id, show.view.can.previous], ["a", false]);
});

test("with reduced motion every way is a cut, and autoplay still lets one read", () => {
  const show = new Show(sampleTour(), "b");
  show.reduced = true;
  show.player.next(show.now);
  show.at("c");
  show.player.previous(show.now);
  show.at("b");
  show.player.look(40, 0, show.now);
  show.player.back(show.now);
  show.at("b");
  assert.equal(show.view.cuts, 3);
  // b has no pause: a second all the same.
  show.player.play(show.now);
  assert.equal(show.after(0.9).stop?.id, "b");
  assert.equal(show.after(0.2).stop?.id, "c");
  // The system's setting may change meanwhile.
  show.reduced = false;
  show.player.previous(show.now);
  show.at("b", "moving");
});

test("a page that was hidden goes one step on, not through all it missed", () => {
  let tour = setNext(sampleTour(), "c", { to: "a", path: { kind: "jump" } });
  tour = setNext(tour, "a", { to: "c", path: { kind: "jump" } });
  for (const id of ["a", "c"]) tour = changeStop(tour, id, { pauseS: 0 });
  const show = new Show(tour, "a");
  show.player.play(show.now);
  show.at("a");
  assert.equal(show.after(36_000).stop?.id, "c");
  show.at("c");
  assert.equal(show.after(1.1).stop?.id, "a");
  assert.equal(show.view.cuts, 2);
});

test("ways keep clear of what is known when they begin", () => {
  const house = terrainOf(40, 20, (column) => (column >= 18 && column < 24 ? 30 : 0), [1, 1], [-10, -10]);
  let heights: typeof house.heights | null = null;
  const options = { tour: sampleTour(), heights: () => heights, reducedMotion: () => false, at: "a" };
  const highest = (player: TourPlayer, beganS: number) => {
    let z = Number.NEGATIVE_INFINITY;
    for (let t = 0; t < 15; t += 0.05) z = Math.max(z, player.view(beganS + t).pose?.eyeEnu[2] ?? 0);
    return z;
  };
  const player = new TourPlayer(options, 0);
  player.next(0);
  assert.ok(highest(player, 0) < 10.01);
  player.previous(20);
  assert.ok(highest(player, 20) < 10.01);
  heights = house.heights;
  player.next(40);
  assert.ok(highest(player, 40) > 30.9);
});

test("heights that come on the way lift the rest of it; at a stop nothing changes", () => {
  const house = terrainOf(40, 20, (column) => (column >= 18 && column < 24 ? 30 : 0), [1, 1], [-10, -10]);
  let heights: typeof house.heights | null = null;
  const options = { tour: sampleTour(), heights: () => heights, reducedMotion: () => false, at: "a" };
  const player = new TourPlayer(options, 0);
  player.replan(0);
  assert.equal(player.view(0).phase, "stop");
  player.next(0);
  const before = player.view(0.3);
  heights = house.heights;
  player.replan(0.3);
  const after = player.view(0.3);
  assert.ok(distance(before, after) < 1e-9);
  assert.deepEqual([after.phase, after.stop?.id], ["moving", before.stop?.id]);
  let nearest = Number.POSITIVE_INFINITY;
  for (let t = 0.3; t < 20; t += 0.02) {
    const [x, y, z] = player.view(t).pose?.eyeEnu ?? [0, 0, 0];
    if (house.heights.at(x, y) === 30) nearest = Math.min(nearest, z - 30);
  }
  assert.ok(nearest > 0.9 && nearest < 3, `${nearest} m above the roof`);
  assert.equal(player.view(20).phase, "stop");
});
