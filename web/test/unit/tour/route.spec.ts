import assert from "node:assert/strict";
import test from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { add, angleBetweenRad, norm, normalize, scale, sub } from "../../../src/base/vec_math.js";
import { anglesOfPose, forward, poseLookingAt, up } from "../../../src/geo/camera.js";
import type { Heights } from "../../../src/tour/heights.js";
import {
  FASTEST_TURN_DEG_PER_S,
  LONGEST_S,
  planRoute,
  poseAt,
  type Route,
  SHORTEST_S,
} from "../../../src/tour/route.js";
import type { Path, TourPose } from "../../../src/tour/types.js";
import { pose } from "./samples.js";
import { distanceToSolid, random, randomEye, randomTerrain, type Terrain, terrainOf } from "./terrains.js";

const DIRECT: Path = { kind: "direct" };
const OVER: Path = { kind: "over" };
const NEAR = 1e-9;

/** The eye at many places of the way, between all its corners. */
function eyes({ points }: Route, stepM = 0.1): Vec3[] {
  return points.flatMap((point, i) => {
    const after = points[i + 1];
    if (after === undefined) return [point];
    const parts = Math.max(1, Math.ceil(norm(sub(after, point)) / stepM));
    return Array.from({ length: parts }, (_, k) => add(point, scale(sub(after, point), k / parts)));
  });
}

function besides(a: Vec3, b: Vec3): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

/** Every place is clear, but those straight above an end that is not. */
function assertClear(route: Route, { cells }: Terrain, what: string): void {
  const ends = [route.from.eyeEnu, route.to.eyeEnu].filter((end) => distanceToSolid(cells, end) < 1);
  for (const eye of eyes(route)) {
    const distance = distanceToSolid(cells, eye);
    if (distance >= 1 - NEAR) continue;
    const excused = ends.some((end) => besides(end, eye) < NEAR);
    assert.ok(excused, `${what}: ${distance} m at ${eye}`);
  }
}

function randomPath(next: () => number, terrain: Terrain): Path {
  const which = next();
  if (which < 0.5) return DIRECT;
  if (which < 0.7) return OVER;
  return { kind: "orbit", about: randomEye(terrain, next) };
}

function times({ durationS }: Route, count: number): number[] {
  return Array.from({ length: count + 1 }, (_, i) => (durationS * i) / count);
}

/** Ends, continuity, speed, turning: what holds for every route. */
function assertSmooth(route: Route, what: string): void {
  assert.deepEqual(poseAt(route, 0), { ...route.from, orthoHeightM: null }, what);
  assert.deepEqual(poseAt(route, route.durationS), { ...route.to, orthoHeightM: null }, what);
  const count = 150;
  const dt = route.durationS / count;
  let before = poseAt(route, 0);
  for (const t of times(route, count).slice(1)) {
    const now = poseAt(route, t);
    const moved = norm(sub(now.eyeEnu, before.eyeEnu));
    assert.ok(moved <= route.fastestMps * dt + 1e-6, `${what}: ${moved} m in ${dt} s, at most ${route.fastestMps} m/s`);
    const turned = (angleBetweenRad(now.rotation, before.rotation) * 180) / Math.PI;
    assert.ok(turned <= FASTEST_TURN_DEG_PER_S * dt * 1.01 + 1e-4, `${what}: ${turned} degrees in ${dt} s`);
    assert.ok(now.eyeEnu.every(Number.isFinite) && now.rotation.every(Number.isFinite), what);
    before = now;
  }
}

test("over random terrains with towers every way keeps a metre, begins and ends where it must, and does not jump", () => {
  for (let seed = 1; seed <= 36; seed += 1) {
    const terrain = randomTerrain(seed);
    const next = random(7 * seed);
    for (let i = 0; i < 4; i += 1) {
      const from = pose(randomEye(terrain, next), 360 * next(), 90 * next() - 80);
      const to = pose(randomEye(terrain, next), 360 * next(), 90 * next() - 80, 30 + 40 * next());
      const path = randomPath(next, terrain);
      const what = `seed ${seed}, way ${i}, ${path.kind}`;
      const route = planRoute(from, to, path, terrain.heights);
      assertClear(route, terrain, what);
      assertSmooth(route, what);
      if (i === 0) assert.deepEqual(planRoute(from, to, path, terrain.heights), route, what);
    }
  }
});

test("the poses in between are on the way", () => {
  for (let seed = 1; seed <= 10; seed += 1) {
    const terrain = randomTerrain(seed);
    const next = random(seed);
    const route = planRoute(pose(randomEye(terrain, next)), pose(randomEye(terrain, next)), DIRECT, terrain.heights);
    const on = eyes(route, 0.02);
    for (const t of times(route, 20)) {
      const { eyeEnu } = poseAt(route, t);
      assert.ok(Math.min(...on.map((place) => norm(sub(place, eyeEnu)))) < 0.011, `seed ${seed}`);
    }
  }
});

const FLAT = terrainOf(100, 100, () => 0);
const HOUSE = terrainOf(100, 100, (column, row) => (column >= 45 && column < 55 && row >= 45 && row < 55 ? 8 : 0));

test("a free way is straight", () => {
  for (const { heights } of [FLAT, { heights: null as Heights | null }]) {
    const route = planRoute(pose([10, 50, 1.7]), pose([90, 50, 3]), DIRECT, heights);
    assert.deepEqual(route.points, [
      [10, 50, 1.7],
      [90, 50, 3],
    ]);
  }
  // Beside the house, 1.05 m from its wall.
  const along = planRoute(pose([10, 43.95, 1.7]), pose([90, 43.95, 1.7]), DIRECT, HOUSE.heights);
  assert.equal(along.points.length, 2);
});

test("an obstacle is flown over, not much higher and not much farther than it must be", () => {
  const route = planRoute(pose([10, 50, 1.7]), pose([90, 50, 1.7]), DIRECT, HOUSE.heights);
  assertClear(route, HOUSE, "house");
  const top = Math.max(...route.points.map((point) => point[2]));
  assert.ok(top >= 9 && top < 10, String(top));
  const shortest = 2 * Math.hypot(34, 7.3) + 12;
  assert.ok(route.lengthM < shortest * 1.05, `${route.lengthM} of ${shortest}`);
  // Rounded: no corner of more than 10 degrees.
  for (let i = 1; i + 1 < route.points.length; i += 1) {
    const [a, b, c] = [route.points[i - 1], route.points[i], route.points[i + 1]];
    assert.ok(a && b && c);
    const angle = Math.acos(Math.min(1, norm(add(normalize(sub(b, a)), normalize(sub(c, b)))) / 2)) * 2;
    assert.ok(angle < 0.18, `corner of ${angle} at ${b}`);
  }
  // The way back is as long.
  const back = planRoute(pose([90, 50, 1.7]), pose([10, 50, 1.7]), DIRECT, HOUSE.heights);
  assert.ok(Math.abs(back.lengthM - route.lengthM) < 0.5);
});

test("a wall thinner than the distance between samples is seen", () => {
  const wall = terrainOf(4000, 3, (column) => (column === 2001 ? 30 : 0), [0.05, 40]);
  const route = planRoute(pose([20, 60, 2]), pose([180, 60, 2]), DIRECT, wall.heights);
  assertClear(route, wall, "wall");
  assert.ok(Math.max(...route.points.map((point) => point[2])) > 30.9);
});

test("ends that are too near leave straight up and are reached straight down", () => {
  const from = pose([20, 50, 0.3]);
  const to = pose([44.5, 50, 2]);
  const route = planRoute(from, to, DIRECT, HOUSE.heights);
  assertClear(route, HOUSE, "near ends");
  assert.deepEqual([route.points[0], route.points.at(-1)], [from.eyeEnu, to.eyeEnu]);
  const rise = route.points.filter((point) => besides(point, from.eyeEnu) < NEAR);
  const fall = route.points.filter((point) => besides(point, to.eyeEnu) < NEAR);
  assert.ok(rise.length >= 2 && Math.max(...rise.map((point) => point[2])) >= 1);
  assert.ok(fall.length >= 2 && Math.max(...fall.map((point) => point[2])) >= 8);
});

test("a way over rises above everything between, also where a straight one were free", () => {
  const lane = planRoute(pose([10, 44, 3]), pose([90, 44, 4]), OVER, HOUSE.heights);
  assertClear(lane, HOUSE, "lane");
  const middle = planRoute(pose([10, 50, 3]), pose([90, 50, 3]), OVER, HOUSE.heights);
  const z = (route: Route, x: number) => eyes(route).find((eye) => eye[0] >= x)?.[2] ?? 0;
  for (const x of [35, 50, 65]) assert.ok(z(middle, x) >= 8.9, `at ${x}: ${z(middle, x)}`);
  const higher = planRoute(pose([10, 50, 50]), pose([90, 50, 20]), OVER, HOUSE.heights);
  for (const x of [15, 30, 45]) assert.ok(Math.abs(z(higher, x) - 50) < 0.01);
  assert.ok(planRoute(pose([10, 50, 50]), pose([90, 50, 20]), OVER, null).lengthM > norm([80, 0, 30]));
});

test("an orbit goes round the shorter way at changing distance and height, looking at the middle", () => {
  const about: Vec3 = [50, 50, 4];
  const from: TourPose = { ...pose([70, 50, 12]), rotation: poseLookingAt([70, 50, 12], about) };
  const to: TourPose = { ...pose([50, 20, 20]), rotation: poseLookingAt([50, 20, 20], about) };
  const route = planRoute(from, to, { kind: "orbit", about }, HOUSE.heights);
  assertClear(route, HOUSE, "orbit");
  assertSmooth(route, "orbit");
  let heading = Number.POSITIVE_INFINITY;
  for (const t of times(route, 100)) {
    const { eyeEnu, rotation } = poseAt(route, t);
    const distance = besides(eyeEnu, about);
    assert.ok(distance > 19.9 && distance < 30.1);
    assert.ok(angleBetweenRad(rotation, poseLookingAt(eyeEnu, about)) < 0.02);
    // From east to south is clockwise.
    const now = Math.atan2(eyeEnu[1] - about[1], eyeEnu[0] - about[0]);
    assert.ok(now <= heading + 1e-9);
    heading = now;
  }
  // Ends that look elsewhere keep their view; the middle of the way looks at the middle.
  const away = planRoute(pose([70, 50, 12], 90), pose([50, 20, 20], 180), { kind: "orbit", about }, null);
  const half = poseAt(away, away.durationS / 2);
  assert.ok(angleBetweenRad(half.rotation, poseLookingAt(half.eyeEnu, about)) < 0.02);
  assertSmooth(away, "away");
});

test("orbits through the middle, half round and from above are ways too", () => {
  const about: Vec3 = [50, 50, 4];
  const ends: [Vec3, Vec3][] = [
    [
      [70, 50, 30],
      [30, 50, 30],
    ],
    [
      [50, 50, 40],
      [50, 20, 20],
    ],
    [
      [50, 20, 20],
      [50, 50, 40],
    ],
    [
      [50, 50, 40],
      [50, 50, 20],
    ],
    [
      [70, 50, 12],
      [60, 50, 12],
    ],
  ];
  for (const [from, to] of ends) {
    const route = planRoute(pose(from, 10, -30), pose(to, 200, -80), { kind: "orbit", about }, HOUSE.heights);
    assertClear(route, HOUSE, `${from} to ${to}`);
    assertSmooth(route, `${from} to ${to}`);
  }
  const half = planRoute(pose([70, 50, 30]), pose([30, 50, 30]), { kind: "orbit", about }, null);
  assert.ok(Math.abs(half.lengthM - 20 * Math.PI) < 0.1);
});

test("what both ends look at stays in the middle of the picture", () => {
  const target: Vec3 = [50, 50, 6];
  const from: TourPose = { ...pose([20, 30, 15]), rotation: poseLookingAt([20, 30, 15], target) };
  const to: TourPose = { ...pose([60, 10, 25]), rotation: poseLookingAt([60, 10, 25], target) };
  const route = planRoute(from, to, DIRECT, null);
  for (const t of times(route, 50)) {
    const { eyeEnu, rotation } = poseAt(route, t);
    const off = norm(sub(forward(rotation), normalize(sub(target, eyeEnu))));
    assert.ok(off < 1e-3, `${off} at ${t}`);
  }
});

test("the horizon stays level between level views, and no camera is ever upside down", () => {
  const next = random(11);
  for (let i = 0; i < 100; i += 1) {
    const place = (): Vec3 => [100 * next(), 100 * next(), 20 + 20 * next()];
    const from = pose(place(), 360 * next(), 100 * next() - 85);
    const to = pose(place(), 360 * next(), 100 * next() - 85);
    const path: Path = i % 2 === 0 ? DIRECT : { kind: "orbit", about: place() };
    const route = planRoute(from, to, path, null);
    for (const t of times(route, 60)) {
      const { rotation } = poseAt(route, t);
      assert.ok(up(rotation)[2] > -1e-6, `way ${i}`);
      const { pitchDeg, rollDeg } = anglesOfPose(rotation);
      if (Math.abs(pitchDeg) < 80) assert.ok(Math.abs(rollDeg) < 0.5, `way ${i}: roll ${rollDeg} at pitch ${pitchDeg}`);
    }
  }
});

test("times are within their limits, and farther never takes less", () => {
  let before = 0;
  for (const metres of [0.01, 1, 10, 50, 100, 1000, 100_000]) {
    const { durationS } = planRoute(pose([0, 0, 5]), pose([metres, 0, 5]), DIRECT, null);
    assert.ok(durationS >= SHORTEST_S && durationS <= LONGEST_S && durationS >= before);
    before = durationS;
  }
  const turn = planRoute(pose([0, 0, 5], 0), pose([0, 0, 5], 180), DIRECT, FLAT.heights);
  assert.ok(turn.durationS >= 180 / FASTEST_TURN_DEG_PER_S && turn.durationS < 6);
  assertSmooth(turn, "turn");
  const zoom = planRoute(pose([0, 0, 5], 0, 0, 30), pose([0, 0, 5], 0, 0, 60), DIRECT, null);
  assert.ok(zoom.durationS >= SHORTEST_S && Math.abs(poseAt(zoom, zoom.durationS / 2).fovyDeg - 45) < 1e-9);
});

test("a jump and a way to the same pose take no time", () => {
  const [from, to] = [pose([0, 0, 5]), pose([9, 9, 9], 90)];
  const jump = planRoute(from, to, { kind: "jump" }, FLAT.heights);
  assert.equal(jump.durationS, 0);
  assert.deepEqual(poseAt(jump, 0), { ...to, orthoHeightM: null });
  for (const path of [DIRECT, OVER, { kind: "orbit", about: [0, 0, 0] } as Path]) {
    assert.equal(planRoute(from, from, path, null).durationS, 0, path.kind);
  }
});

test("far away, in one cell and over holes ways are ways", () => {
  const one = terrainOf(1, 1, () => 5);
  const holes = terrainOf(30, 30, () => Number.NaN);
  const ends: [Vec3, Vec3][] = [
    [
      [-1e9, 0, 0],
      [1e9, 0, 0],
    ],
    [
      [-1e6, -1e6, 3],
      [1e6, 1e6, 3],
    ],
    [
      [0.5, 0.5, 5.2],
      [0.5, 0.5, 30],
    ],
    [
      [0.5, 0.5, 2],
      [0.5, 0.5, 30],
    ],
    [
      [-3, 0.5, 5.5],
      [4, 0.5, 5.5],
    ],
    [
      [5000, 5000, -7],
      [6000, 5000, -7],
    ],
  ];
  for (const terrain of [one, holes, HOUSE]) {
    for (const [from, to] of ends) {
      for (const path of [DIRECT, OVER, { kind: "orbit", about: [0, 0, 0] } as Path]) {
        const route = planRoute(pose(from), pose(to, 90), path, terrain.heights);
        assertSmooth(route, `${from} to ${to} ${path.kind}`);
        if (route.lengthM < 1000) assertClear(route, terrain, `${from} to ${to} ${path.kind}`);
      }
    }
  }
});
