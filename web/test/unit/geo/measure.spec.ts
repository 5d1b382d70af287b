import assert from "node:assert/strict";
import test from "node:test";
import type { Vec2, Vec3 } from "../../../src/base/vec.js";
import { add, cross, norm, normalize, scale, sub } from "../../../src/base/vec_math.js";
import { pointCovariance, varianceAlong } from "../../../src/geo/covariance.js";
import {
  area,
  areaVector,
  crossesItself,
  distance,
  type Estimate,
  knowsGeoReference,
  type PlaceAccuracy,
  pointSigma,
  volume,
} from "../../../src/geo/measure.js";
import type { SurfacePoint } from "../../../src/state/app_state.js";
import { NO_ACCURACY, samplePoint, seededNormal, seededRandom } from "../state/samples.js";

const ACCURACY: PlaceAccuracy = { ...NO_ACCURACY, scalePercent: 0.4, tiltDeg: 0.3 };
const NOISE_RUNS = 20_000;

function near(found: number | null, expected: number, share: number, what: string): void {
  assert.ok(
    found !== null && Math.abs(found - expected) <= share * Math.abs(expected),
    `${what}: ${found}, not ${expected}`,
  );
}

/** A point as the model says that it could have been found instead. */
function disturbed(point: SurfacePoint, normal: () => number): SurfacePoint {
  const d = normalize(point.direction);
  const aside = normalize(cross(d, Math.abs(d[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  const third = cross(d, aside);
  const half = point.pixelM / 2;
  const step = add(
    scale(d, (point.spreadM ?? 0) * normal()),
    add(scale(aside, half * normal()), scale(third, half * normal())),
  );
  return { ...point, enu: add(point.enu, step) };
}

/** The whole frame scaled and tilted about a random horizontal axis, as the accuracy says. */
function placed(points: readonly SurfacePoint[], accuracy: PlaceAccuracy, normal: () => number): SurfacePoint[] {
  const factor = 1 + ((accuracy.scalePercent ?? 0) / 100) * normal();
  const rad = ((accuracy.tiltDeg ?? 0) * Math.PI) / 180 / Math.SQRT2;
  const [a, b] = [rad * normal(), rad * normal()];
  return points.map((point) => {
    const [x, y, z] = scale(point.enu, factor);
    return { ...point, enu: [x - a * z, y - b * z, z + a * x + b * y] };
  });
}

/** Standard deviation of what `measure` gives for disturbed points. */
function monteCarlo(
  points: readonly SurfacePoint[],
  accuracy: PlaceAccuracy,
  measure: (p: readonly SurfacePoint[]) => number,
): number {
  const normal = seededNormal(7);
  let sum = 0;
  let squares = 0;
  const middle = measure(points);
  for (let run = 0; run < NOISE_RUNS; run += 1) {
    const value =
      measure(
        placed(
          points.map((point) => disturbed(point, normal)),
          accuracy,
          normal,
        ),
      ) - middle;
    sum += value;
    squares += value * value;
  }
  return Math.sqrt(squares / NOISE_RUNS - (sum / NOISE_RUNS) ** 2);
}

// An uneven outline on a slope, seen obliquely.
const LINE: readonly SurfacePoint[] = [
  samplePoint([10, 5, 3], 0.08, [0.5, 0.2, -0.8]),
  samplePoint([18, 9, 5.5], 0.03, [-0.1, 0.4, -0.9]),
  samplePoint([24, 4, 9], 0.12, [0.7, -0.1, -0.3]),
  samplePoint([15, -6, 4], 0.05, [0, 0, -1]),
];

test("a point is uncertain along its ray by its spread and across it by half a pixel", () => {
  const point = samplePoint([0, 0, 0], 0.3, [3, 4, 0]);
  const c = pointCovariance(point);
  assert.ok(c !== null);
  near(varianceAlong(c, [0.6, 0.8, 0]), 0.09, 1e-9, "along");
  near(varianceAlong(c, [-0.8, 0.6, 0]), 0.0001, 1e-9, "across");
  near(varianceAlong(c, [0, 0, 1]), 0.0001, 1e-9, "up");
  assert.equal(pointCovariance({ ...point, spreadM: null }), null);
  assert.equal(pointCovariance({ ...point, spreadM: Number.NaN }), null);
  assert.equal(pointCovariance({ ...point, direction: [0, 0, 0] }), null);
});

test("deviations of distances are those of disturbed points", () => {
  for (const accuracy of [NO_ACCURACY, ACCURACY]) {
    const found = distance(LINE, accuracy);
    const parts = ["slope", "plan", "rise"] as const;
    for (const part of parts) {
      const expected = monteCarlo(LINE, accuracy, (points) => distance(points, NO_ACCURACY)[part].value);
      near(found[part].sigma, expected, 0.03, part);
    }
  }
});

test("deviations of areas are those of disturbed points", () => {
  for (const accuracy of [NO_ACCURACY, ACCURACY]) {
    const found = area(LINE, accuracy);
    for (const part of ["plan", "sloped", "perimeter"] as const) {
      const expected = monteCarlo(LINE, accuracy, (points) => area(points, NO_ACCURACY)[part].value);
      near(found[part].sigma, expected, 0.03, part);
    }
  }
});

test("a tilt turns plan distances into heights, a scale does not", () => {
  const flat = [samplePoint([0, 0, 0], 0), samplePoint([300, 400, 0], 0)].map((point) => ({ ...point, pixelM: 0 }));
  const { slope, plan, rise } = distance(flat, { ...NO_ACCURACY, tiltDeg: 0.1, scalePercent: 0.2 });
  near(slope.sigma, 1, 1e-9, "slope by the scale");
  near(plan.sigma, 1, 1e-9, "plan by the scale");
  near(rise.sigma, (500 * 0.1 * Math.PI) / 180 / Math.SQRT2, 1e-9, "rise by the tilt");
});

test("distance along a line: slope, plan, rise", () => {
  const { slope, plan, rise } = distance(
    [samplePoint([0, 0, 0]), samplePoint([3, 4, 12]), samplePoint([3, 4, 10])],
    NO_ACCURACY,
  );
  assert.equal(slope.value, 15);
  assert.equal(plan.value, 5);
  assert.equal(rise.value, 10);
});

test("areas: turned either way, concave, vertical, far from the origin", () => {
  const outline = (corners: readonly Vec3[]) => corners.map((corner) => samplePoint(corner));
  const bracket: Vec3[] = [
    [0, 0, 0],
    [4, 0, 0],
    [4, 4, 0],
    [3, 4, 0],
    [3, 1, 0],
    [0, 1, 0],
  ];
  for (const corners of [bracket, [...bracket].reverse()]) {
    near(area(outline(corners), NO_ACCURACY).plan.value, 7, 1e-12, "plan");
    near(area(outline(corners), NO_ACCURACY).sloped.value, 7, 1e-12, "sloped");
    near(area(outline(corners), NO_ACCURACY).perimeter.value, 16, 1e-12, "perimeter");
  }
  // A roof of 45 degrees.
  const roof = area(outline(bracket.map(([x, y]): Vec3 => [x, y, x])), NO_ACCURACY);
  near(roof.plan.value, 7, 1e-12, "plan of the roof");
  near(roof.sloped.value, 7 * Math.SQRT2, 1e-12, "the roof itself");
  const wall = area(
    outline([
      [0, 0, 0],
      [5, 0, 0],
      [5, 0, 3],
      [0, 0, 3],
    ]),
    NO_ACCURACY,
  );
  assert.equal(wall.plan.value, 0);
  assert.ok(wall.plan.sigma !== null && wall.plan.sigma > 0);
  near(wall.sloped.value, 15, 1e-12, "wall");
  const far: Vec3 = [4e6, -3e6, 5e3];
  near(area(outline(bracket.map((corner) => add(corner, far))), NO_ACCURACY).plan.value, 7, 1e-8, "far away");
});

test("the area does not depend on the first corner", () => {
  const random = seededRandom(3);
  for (let run = 0; run < 50; run += 1) {
    const corners = Array.from({ length: 3 + (run % 6) }, (): Vec3 => [10 * random(), 10 * random(), 10 * random()]);
    const turned = [...corners.slice(1), ...corners.slice(0, 1)];
    assert.ok(norm(sub(areaVector(corners), areaVector(turned))) < 1e-9);
  }
});

test("too few, repeated, collinear and broken points give numbers or no deviation, never NaN in sigma", () => {
  const a = samplePoint([1, 2, 3]);
  for (const points of [[], [a]]) {
    assert.deepEqual(distance(points, ACCURACY).slope, { value: 0, sigma: null });
    assert.deepEqual(area(points, ACCURACY).plan, { value: 0, sigma: null });
    assert.deepEqual(area(points, ACCURACY).perimeter, { value: 0, sigma: null });
  }
  const same = distance([a, a], ACCURACY);
  assert.equal(same.slope.value, 0);
  // What two points at one place seem to be apart, as mean square.
  near(same.slope.sigma, Math.sqrt(2 * (0.05 ** 2 + 2 * 0.01 ** 2)), 1e-9, "at one place");
  const vertical = distance([a, samplePoint([1, 2, 13])], ACCURACY);
  near(vertical.slope.sigma, Math.hypot(0.05 * Math.SQRT2, 0.04), 1e-9, "vertical");
  assert.ok(vertical.plan.sigma !== null && vertical.plan.sigma > 0);
  const straight = area([a, samplePoint([2, 4, 6]), samplePoint([3, 6, 9])], ACCURACY);
  assert.ok(straight.sloped.value < 1e-9 && straight.sloped.sigma !== null && straight.sloped.sigma > 0);
  const repeated = area([a, a, a], ACCURACY);
  assert.equal(repeated.plan.value, 0);
  assert.equal(repeated.plan.sigma, 0);
  const broken: Estimate[] = [
    ...Object.values(distance([a, samplePoint([Number.NaN, 0, 0])], ACCURACY)),
    ...Object.values(area([a, samplePoint([Number.NaN, 0, 0]), samplePoint([1, 1, 1])], ACCURACY)),
  ];
  for (const { value, sigma } of broken) assert.ok((Number.isNaN(value) && sigma === null) || Number.isFinite(value));
});

test("one point of the mesh leaves the deviation unknown, an unknown geo-reference does not", () => {
  const points = [samplePoint([0, 0, 0]), samplePoint([3, 4, 0], null)];
  assert.deepEqual(distance(points, ACCURACY).slope, { value: 5, sigma: null });
  assert.equal(area([...points, samplePoint([0, 5, 0])], ACCURACY).plan.sigma, null);
  assert.equal(knowsGeoReference(NO_ACCURACY), false);
  assert.equal(knowsGeoReference(ACCURACY), true);
});

test("a volume adds depths, outline and scale", () => {
  const outline = [
    samplePoint([0, 0, 0], 0),
    samplePoint([10, 0, 0], 0),
    samplePoint([10, 10, 0], 0),
    samplePoint([0, 10, 0], 0),
  ];
  near(
    volume(
      500,
      4,
      outline.map((point) => ({ ...point, pixelM: 0 })),
      NO_ACCURACY,
    ).sigma,
    4,
    1e-9,
    "depths alone",
  );
  const plan = area(outline, NO_ACCURACY).plan.sigma ?? 0;
  near(volume(500, 0, outline, NO_ACCURACY).sigma, 5 * plan, 1e-9, "outline");
  near(volume(-500, 4, outline, { ...NO_ACCURACY, scalePercent: 1 }).sigma, Math.hypot(4, 5 * plan, 15), 1e-9, "all");
  assert.equal(volume(500, null, outline, ACCURACY).sigma, null);
  assert.equal(volume(500, 4, [samplePoint([0, 0, 0], null), ...outline.slice(1)], ACCURACY).sigma, null);
  assert.equal(volume(500, 4, [], ACCURACY).sigma, null);
});

test("a point's coordinates contain the accuracy of the place, more of it away from the middle", () => {
  const accuracy = { scalePercent: 1, tiltDeg: 0, yawDeg: 0, horizontalM: 3, verticalM: 4 };
  const point = { ...samplePoint([100, 0, 0], 0), pixelM: 0 };
  const there = pointSigma(point, accuracy, [100, 0, 0]);
  near(there.horizontalM, 3, 1e-9, "in the middle");
  near(there.verticalM, 4, 1e-9, "height in the middle");
  near(pointSigma(point, accuracy, [0, 0, 0]).horizontalM, Math.hypot(3, 1), 1e-9, "by the scale");
  near(
    pointSigma(point, { ...accuracy, scalePercent: 0, yawDeg: 1 }, [0, 0, 0]).horizontalM,
    Math.hypot(3, Math.PI / 1.8),
    1e-9,
    "by the yaw",
  );
  assert.deepEqual(pointSigma(samplePoint([0, 0, 0], null), accuracy, [0, 0, 0]), {
    horizontalM: null,
    verticalM: null,
  });
});

test("outlines that cross, touch or go back over themselves are found", () => {
  const square: Vec2[] = [
    [0, 0],
    [2, 0],
    [2, 2],
    [0, 2],
  ];
  assert.equal(crossesItself(square), false);
  assert.equal(crossesItself([...square].reverse()), false);
  assert.equal(
    crossesItself([
      [0, 0],
      [4, 0],
      [4, 4],
      [2, 1],
      [0, 4],
    ]),
    false,
  );
  assert.equal(
    crossesItself([
      [0, 0],
      [2, 2],
      [2, 0],
      [0, 2],
    ]),
    true,
  );
  // A corner on another edge.
  assert.equal(
    crossesItself([
      [0, 0],
      [4, 0],
      [4, 4],
      [2, 0],
      [0, 4],
    ]),
    true,
  );
  assert.equal(
    crossesItself([
      [0, 0],
      [2, 0],
      [2, 0],
      [0, 2],
    ]),
    true,
  );
  assert.equal(
    crossesItself([
      [0, 0],
      [4, 0],
      [2, 0],
    ]),
    true,
  );
});
