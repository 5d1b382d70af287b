import assert from "node:assert/strict";
import { test } from "node:test";
import type { Vec2, Vec3 } from "../../../src/base/vec.js";
import { norm, sub } from "../../../src/base/vec_math.js";
import { anglesOfPose, right, rotationFromAngles } from "../../../src/geo/camera.js";
import { Flight } from "../../../src/scene/flight.js";
import { obliqueFromTop, obliquePose, perspectiveOf, topFrom, topPose } from "../../../src/scene/framing.js";
import { HeldKeys, moveOfKey } from "../../../src/scene/key_input.js";
import { flyBy, keepNear, orbit, panBy, panTo, turn, zoomAt } from "../../../src/scene/map_motion.js";
import { cornersOf, projectPoint } from "../../../src/scene/view_math.js";
import { makeWorld } from "../../../src/scene/world.js";
import { lookingAt, sampleBase } from "./samples.js";

const SIZE: Vec2 = [400, 250];
const WORLD = makeWorld(sampleBase());
const OBLIQUE = lookingAt([10, -120, 90], [0, 0, 0]);
const TOP = { ...lookingAt([5, 6, 80], [5, 6, 0]), orthoHeightM: 150 };

function near(a: Vec2 | null, b: Vec2, text: string): void {
  assert.ok(a !== null && Math.hypot(a[0] - b[0], a[1] - b[1]) < 1e-6, `${text}: ${a} is not ${b}`);
}

test("a drag keeps the grabbed place under the pointer and the height of the eye", () => {
  for (const pose of [OBLIQUE, TOP]) {
    const place: Vec3 = [12, 7, 3];
    const moved = panTo(pose, SIZE, place, [111, 187]);
    near(projectPoint(moved, SIZE, place), [111, 187], "grabbed");
    assert.equal(moved.eyeEnu[2], pose.eyeEnu[2]);
    assert.deepEqual(moved.rotation, pose.rotation);
  }
});

test("a drag to the horizon does not throw the camera away", () => {
  const flat = lookingAt([0, -50, 5], [0, 0, 4]);
  const moved = panTo(flat, SIZE, [0, 0, 0], [200, 10]);
  assert.ok(norm(sub(moved.eyeEnu, flat.eyeEnu)) < 1000);
});

test("the wheel keeps the place under the pointer", () => {
  const place: Vec3 = [30, 20, 8];
  for (const pose of [OBLIQUE, TOP]) {
    const before = projectPoint(pose, SIZE, place);
    assert.ok(before !== null);
    const closer = zoomAt(pose, place, 0.5, WORLD);
    near(projectPoint(closer, SIZE, place), before, "zoomed");
    if (pose.orthoHeightM === null)
      assert.ok(Math.abs(norm(sub(closer.eyeEnu, place)) / norm(sub(pose.eyeEnu, place)) - 0.5) < 1e-9);
    else assert.equal(closer.orthoHeightM, 75);
  }
});

test("zooming has ends on both sides", () => {
  let [closer, farther] = [OBLIQUE, OBLIQUE];
  for (let i = 0; i < 200; i += 1) {
    closer = zoomAt(closer, [0, 0, 0], 0.7, WORLD);
    farther = zoomAt(farther, [0, 0, 0], 1.4, WORLD);
  }
  assert.ok(norm(closer.eyeEnu) >= 0.3 - 1e-9 && norm(closer.eyeEnu) < 0.31);
  assert.ok(norm(farther.eyeEnu) <= 6 * WORLD.sizeM + 1e-6);
  let top = TOP;
  for (let i = 0; i < 200; i += 1)
    top = {
      ...top,
      ...zoomAt(top, [0, 0, 0], 0.5, WORLD),
      orthoHeightM: zoomAt(top, [0, 0, 0], 0.5, WORLD).orthoHeightM ?? 0,
    };
  assert.equal(top.orthoHeightM, 0.5);
});

test("turning about a place keeps its pixel, its distance and a level horizon, and stops before the horizon and at straight down", () => {
  const place: Vec3 = [3, -4, 6];
  const before = projectPoint(OBLIQUE, SIZE, place);
  assert.ok(before !== null);
  for (const [yaw, pitch] of [
    [25, 0],
    [0, -20],
    [-140, 12],
    [400, 1000],
    [0, -1000],
  ] as const) {
    const turned = orbit(OBLIQUE, place, yaw, pitch);
    near(projectPoint(turned, SIZE, place), before, `turned by ${yaw} ${pitch}`);
    assert.ok(Math.abs(norm(sub(turned.eyeEnu, place)) - norm(sub(OBLIQUE.eyeEnu, place))) < 1e-9);
    assert.ok(Math.abs(right(turned.rotation)[2]) < 1e-9);
    const { pitchDeg } = anglesOfPose(turned.rotation);
    assert.ok(pitchDeg >= -90 - 1e-9 && pitchDeg <= -5 + 1e-9, `${pitchDeg}`);
  }
  assert.ok(
    Math.abs(
      anglesOfPose(orbit(OBLIQUE, place, 25, 0).rotation).yawDeg - ((anglesOfPose(OBLIQUE.rotation).yawDeg + 25) % 360),
    ) < 1e-9,
  );
});

test("the view from above turns about a place as well", () => {
  const place: Vec3 = [25, 6, 0];
  const before = projectPoint(TOP, SIZE, place);
  const turned = orbit(TOP, place, 90, 0);
  assert.ok(before !== null);
  near(projectPoint(turned, SIZE, place), before, "turned");
  assert.ok(Math.abs(anglesOfPose(turned.rotation).yawDeg - 90) < 1e-6);
});

test("keys pan along the picture, also from straight above", () => {
  const east = { ...TOP, rotation: rotationFromAngles({ yawDeg: 90, pitchDeg: -90, rollDeg: 0 }) };
  // 250 pixels are 150 m; up in the picture is east.
  const moved = panBy(east, SIZE, [0, 25], 1);
  assert.ok(Math.abs(moved.eyeEnu[0] - TOP.eyeEnu[0] - 15) < 1e-9 && Math.abs(moved.eyeEnu[1] - TOP.eyeEnu[1]) < 1e-9);
  const ahead = flyBy({ ...OBLIQUE, rotation: rotationFromAngles({ yawDeg: 90, pitchDeg: 0, rollDeg: 0 }) }, 2, 3, 4);
  assert.ok(norm(sub(sub(ahead.eyeEnu, OBLIQUE.eyeEnu), [3, -2, 4])) < 1e-9);
});

test("looking around ends short of straight up; the eye stays", () => {
  const up = turn(OBLIQUE, 10, 500);
  assert.deepEqual(up.eyeEnu, OBLIQUE.eyeEnu);
  assert.ok(Math.abs(anglesOfPose(up.rotation).pitchDeg - 89) < 1e-6);
});

test("the camera stays near the scene", () => {
  const lost = keepNear({ ...OBLIQUE, eyeEnu: [1e9, -1e9, 1e9] }, WORLD);
  assert.ok(norm(lost.eyeEnu) < 30 * WORLD.sizeM + 1000);
  assert.equal(keepNear(OBLIQUE, WORLD), OBLIQUE);
});

test("the first view comes from the south and fills the picture with the box", () => {
  for (const size of [SIZE, [300, 900] as const, [1900, 400] as const]) {
    const pose = obliquePose(WORLD.boxEnu, size);
    const { yawDeg, pitchDeg } = anglesOfPose(pose.rotation);
    assert.ok((yawDeg < 1e-6 || yawDeg > 360 - 1e-6) && Math.abs(pitchDeg + 45) < 1e-9);
    const corners = cornersOf(WORLD.boxEnu).map((corner) => projectPoint(pose, size, corner));
    let [widest, highest] = [0, 0];
    for (const px of corners) {
      assert.ok(px !== null && px[0] >= 0 && px[0] <= size[0] && px[1] >= 0 && px[1] <= size[1], `${px} in ${size}`);
      widest = Math.max(widest, Math.abs(px[0] / size[0] - 0.5));
      highest = Math.max(highest, Math.abs(px[1] / size[1] - 0.5));
    }
    assert.ok(Math.max(widest, highest) > 0.45, `${widest} ${highest}`);
  }
  const top = topPose(WORLD.boxEnu, SIZE, WORLD);
  for (const corner of cornersOf(WORLD.boxEnu)) {
    const px = projectPoint(top, SIZE, corner);
    assert.ok(px !== null && px[0] >= 0 && px[0] <= SIZE[0] && px[1] >= 0 && px[1] <= SIZE[1]);
  }
});

test("between perspective and the view from above the ground keeps its scale", () => {
  const same = perspectiveOf(TOP, WORLD);
  for (const place of [
    [5, 6, WORLD.groundM],
    [30, -20, WORLD.groundM],
  ] as const) {
    const before = projectPoint(TOP, SIZE, place);
    assert.ok(before !== null);
    near(projectPoint(same, SIZE, place), before, "perspective");
  }
  const focus: Vec3 = [10, 20, WORLD.groundM];
  const top = topFrom(lookingAt([10, -80, 100], focus), focus, WORLD);
  near(projectPoint(top, SIZE, focus), [200, 125], "focus");
  const back = obliqueFromTop(TOP, WORLD);
  near(projectPoint(back, SIZE, [5, 6, WORLD.groundM]), [200, 125], "middle");
  assert.equal(back.orthoHeightM, null);
});

test("a flight begins at its first step, arrives exactly, and ends when another begins", async () => {
  const flight = new Flight();
  const arrived: string[] = [];
  void flight
    .start(OBLIQUE, [{ to: lookingAt([0, 0, 50], [0, 10, 0]), durationMs: 100 }])
    .then(() => arrived.push("first"));
  const middle = { ...OBLIQUE, eyeEnu: [1, 2, 3] as Vec3 };
  const end = { ...TOP };
  void flight
    .start(OBLIQUE, [
      { to: middle, durationMs: 100 },
      { to: end, durationMs: 0 },
    ])
    .then(() => arrived.push("second"));
  await Promise.resolve();
  assert.deepEqual(arrived, ["first"]);
  assert.equal(flight.target, end);
  assert.deepEqual(flight.step(5000)?.eyeEnu, OBLIQUE.eyeEnu);
  const half = flight.step(5050)?.eyeEnu;
  assert.ok(half !== undefined && Math.abs(half[0] - (OBLIQUE.eyeEnu[0] + 1) / 2) < 1e-9);
  assert.equal(flight.step(5100), end);
  assert.equal(flight.active, false);
  assert.equal(flight.step(5200), null);
  await Promise.resolve();
  assert.deepEqual(arrived, ["first", "second"]);
});

test("a key counts for at least a tenth of a second, and as long as it is held", () => {
  const keys = new HeldKeys();
  keys.down("ArrowUp", "up");
  keys.up("ArrowUp");
  let total = 0;
  for (let i = 0; i < 20 && keys.active; i += 1) for (const held of keys.step(16)) total += held.ms;
  assert.equal(total, 100);
  assert.equal(keys.active, false);
  keys.down("KeyW", "ahead");
  total = 0;
  for (let i = 0; i < 30; i += 1) for (const held of keys.step(16)) total += held.ms;
  assert.equal(total, 480);
  keys.up("KeyW");
  assert.deepEqual(keys.step(16), []);
  assert.equal(keys.active, false);
});

test("letters move only in flight", () => {
  assert.equal(moveOfKey({ key: "w", code: "KeyW" }, "map"), null);
  assert.equal(moveOfKey({ key: "w", code: "KeyW" }, "fly"), "ahead");
  assert.equal(moveOfKey({ key: "ArrowLeft", code: "ArrowLeft" }, "top"), "left");
  assert.equal(moveOfKey({ key: "+", code: "Equal" }, "map"), "in");
  assert.equal(moveOfKey({ key: "x", code: "KeyX" }, "fly"), null);
});
