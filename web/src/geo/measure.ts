// What is measured between picked points, each value with one standard deviation. ENU, metres.
//
// The deviation has two parts, added as variances:
// - of the points: each has the covariance of covariance.ts, independent of the others, propagated to first order;
// - of the geo-reference, which moves all points together: scale_percent of every length (twice that of areas, three times of volumes), and tilt_deg,
//   which turns plan distances into heights and heights into plan distances. tilt_deg is the angle about both horizontal axes together, so in any one
//   direction it is tilt_deg / sqrt(2). Absolute coordinates have horizontal_m and vertical_m in addition; differences do not.
// A part that is unknown is left out when it is the geo-reference's (knowsGeoReference says so), and makes sigma null when it is a point's.
import type { Vec2, Vec3 } from "../base/vec.js";
import { cross, norm, scale, sub } from "../base/vec_math.js";
import {
  type Covariance,
  crossVariance,
  type MeasuredPoint,
  planTrace,
  pointCovariance,
  trace,
  varianceAlong,
} from "./covariance.js";

/** Value with one standard deviation; sigma null: unknown. */
export interface Estimate {
  readonly value: number;
  readonly sigma: number | null;
}

/** One standard deviation each, null: unknown (state/project.ts, Accuracy). */
export interface PlaceAccuracy {
  readonly scalePercent: number | null;
  readonly tiltDeg: number | null;
  readonly yawDeg: number | null;
  readonly horizontalM: number | null;
  readonly verticalM: number | null;
}

const UP: Vec3 = [0, 0, 1];
const NO_VALUE: Estimate = { value: 0, sigma: null };

/** False: the deviations lack the geo-reference's part, wholly or partly. */
export function knowsGeoReference(accuracy: PlaceAccuracy): boolean {
  return accuracy.scalePercent !== null && accuracy.tiltDeg !== null;
}

function scaleShare(accuracy: PlaceAccuracy): number {
  return (accuracy.scalePercent ?? 0) / 100;
}

/** In one direction, radians. */
function tiltShare(accuracy: PlaceAccuracy): number {
  return ((accuracy.tiltDeg ?? 0) * Math.PI) / 180 / Math.SQRT2;
}

function estimate(value: number, pointVariance: number | null, shares: readonly number[]): Estimate {
  if (!Number.isFinite(value)) return { value: Number.NaN, sigma: null };
  const sigma = pointVariance === null ? null : Math.hypot(Math.sqrt(Math.max(0, pointVariance)), ...shares);
  return { value, sigma: sigma !== null && Number.isFinite(sigma) ? sigma : null };
}

function covariances(points: readonly MeasuredPoint[]): readonly Covariance[] | null {
  const list: Covariance[] = [];
  for (const point of points) {
    const c = pointCovariance(point);
    if (c === null) return null;
    list.push(c);
  }
  return list;
}

function inPlan(v: Vec3): Vec3 {
  return [v[0], v[1], 0];
}

/** Length of the line through the points, in space or in plan, with the variance that the points give it. */
function lineLength(
  points: readonly MeasuredPoint[],
  all: readonly Covariance[] | null,
  plan: boolean,
  closed: boolean,
): { readonly length: number; readonly variance: number | null } {
  const gradients: Vec3[] = points.map(() => [0, 0, 0]);
  let length = 0;
  let variance = 0;
  const sections = closed ? points.length : points.length - 1;
  for (let i = 0; i < sections; i += 1) {
    const j = (i + 1) % points.length;
    const a = points[i];
    const b = points[j];
    if (a === undefined || b === undefined) continue;
    const step = plan ? inPlan(sub(b.enu, a.enu)) : sub(b.enu, a.enu);
    const section = norm(step);
    length += section;
    const ca = all?.[i];
    const cb = all?.[j];
    if (ca === undefined || cb === undefined) continue;
    if (section > 0) {
      const unit = scale(step, 1 / section);
      gradients[i] = sub(gradients[i] ?? [0, 0, 0], unit);
      gradients[j] = sub(gradients[j] ?? [0, 0, 0], scale(unit, -1));
    } else {
      // Without a direction there is no first order: the mean square of the length that the deviations alone make.
      variance += plan ? planTrace(ca) + planTrace(cb) : trace(ca) + trace(cb);
    }
  }
  all?.forEach((c, i) => {
    variance += varianceAlong(c, gradients[i] ?? [0, 0, 0]);
  });
  return { length, variance: all === null ? null : variance };
}

/** Sum of the unit plan directions of the sections times their rise: what a tilt changes the plan length by, per radian. */
function tiltOfPlan(points: readonly MeasuredPoint[]): number {
  let x = 0;
  let y = 0;
  for (let i = 0; i + 1 < points.length; i += 1) {
    const a = points[i];
    const b = points[i + 1];
    if (a === undefined || b === undefined) continue;
    const step = sub(b.enu, a.enu);
    const plan = Math.hypot(step[0], step[1]);
    if (plan > 0) {
      x += (step[2] * step[0]) / plan;
      y += (step[2] * step[1]) / plan;
    }
  }
  return Math.hypot(x, y);
}

/** Along the points in order, in space and in plan; the rise from the first to the last. Fewer than two points: 0 without a deviation. */
export function distance(
  points: readonly MeasuredPoint[],
  accuracy: PlaceAccuracy,
): { readonly slope: Estimate; readonly plan: Estimate; readonly rise: Estimate } {
  const first = points[0];
  const last = points[points.length - 1];
  if (first === undefined || last === undefined || points.length < 2) {
    return { slope: NO_VALUE, plan: NO_VALUE, rise: NO_VALUE };
  }
  const all = covariances(points);
  const slope = lineLength(points, all, false, false);
  const plan = lineLength(points, all, true, false);
  const ends = sub(last.enu, first.enu);
  const riseVariance = all === null ? null : (all[0]?.[5] ?? 0) + (all[all.length - 1]?.[5] ?? 0);
  const s = scaleShare(accuracy);
  const tilt = tiltShare(accuracy);
  return {
    slope: estimate(slope.length, slope.variance, [s * slope.length]),
    plan: estimate(plan.length, plan.variance, [s * plan.length, tilt * tiltOfPlan(points)]),
    rise: estimate(ends[2], riseVariance, [s * ends[2], tilt * Math.hypot(ends[0], ends[1])]),
  };
}

/** Half the sum of cross products: its length is the area on the plane that fits the outline, its z the signed plan area (shoelace formula). */
export function areaVector(points: readonly Vec3[]): Vec3 {
  const first = points[0];
  if (first === undefined) return [0, 0, 0];
  let sum: Vec3 = [0, 0, 0];
  for (let i = 1; i + 1 < points.length; i += 1) {
    // From the first corner: coordinates far from the origin keep their digits.
    const c = cross(sub(points[i] ?? first, first), sub(points[i + 1] ?? first, first));
    sum = [sum[0] + c[0] / 2, sum[1] + c[1] / 2, sum[2] + c[2] / 2];
  }
  return sum;
}

/** Plan area, area on the plane that fits the outline (roofs, faces of quarries), perimeter in space. Fewer than three points: areas 0. */
export function area(
  points: readonly MeasuredPoint[],
  accuracy: PlaceAccuracy,
): { readonly plan: Estimate; readonly sloped: Estimate; readonly perimeter: Estimate } {
  if (points.length < 3) {
    return { plan: NO_VALUE, sloped: NO_VALUE, perimeter: distance(points, accuracy).slope };
  }
  const all = covariances(points);
  const vector = areaVector(points.map((point) => point.enu));
  const plan = Math.abs(vector[2]);
  const sloped = norm(vector);
  const n: Vec3 = sloped > 0 ? scale(vector, 1 / sloped) : UP;
  let planVariance = 0;
  let slopedVariance = 0;
  all?.forEach((c, i) => {
    const before = points[(i + points.length - 1) % points.length];
    const after = points[(i + 1) % points.length];
    if (before === undefined || after === undefined) return;
    // Moving a corner by x changes the vector by half of x cross q.
    const q = scale(sub(after.enu, before.enu), 0.5);
    planVariance += varianceAlong(c, cross(q, UP));
    slopedVariance += sloped > 0 ? varianceAlong(c, cross(q, n)) : crossVariance(c, q);
  });
  const outline = lineLength(points, all, false, true);
  const s = scaleShare(accuracy);
  return {
    plan: estimate(plan, all === null ? null : planVariance, [
      2 * s * plan,
      tiltShare(accuracy) * Math.hypot(vector[0], vector[1]),
    ]),
    sloped: estimate(sloped, all === null ? null : slopedVariance, [2 * s * sloped]),
    perimeter: estimate(outline.length, outline.variance, [s * outline.length]),
  };
}

/**
 * Deviation of a volume: `depthSigmaM3` of the depths inside (from the engine), the outline's (mean height above the base times the deviation of the
 * plan area) and the scale's (three times of every length).
 */
export function volume(
  netM3: number,
  depthSigmaM3: number | null,
  outline: readonly MeasuredPoint[],
  accuracy: PlaceAccuracy,
): Estimate {
  const none: PlaceAccuracy = {
    scalePercent: null,
    tiltDeg: null,
    yawDeg: null,
    horizontalM: null,
    verticalM: null,
  };
  const plan = area(outline, none).plan;
  const known = depthSigmaM3 !== null && Number.isFinite(depthSigmaM3) && plan.sigma !== null && plan.value > 0;
  const edge = plan.value > 0 ? (Math.abs(netM3) / plan.value) * (plan.sigma ?? 0) : 0;
  return estimate(netM3, known ? (depthSigmaM3 ?? 0) ** 2 : null, [edge, 3 * scaleShare(accuracy) * netM3]);
}

/**
 * Deviation of a point's coordinates: in plan (east and north together, as the project's horizontal_m) and in height. Scale, tilt and yaw count from
 * the middle of the survey, where horizontal_m and vertical_m hold.
 */
export function pointSigma(
  point: MeasuredPoint,
  accuracy: PlaceAccuracy,
  middleEnu: Vec3,
): { readonly horizontalM: number | null; readonly verticalM: number | null } {
  const c = pointCovariance(point);
  if (c === null || !point.enu.every(Number.isFinite)) return { horizontalM: null, verticalM: null };
  const from = sub(point.enu, middleEnu);
  const s = scaleShare(accuracy);
  const tilt = tiltShare(accuracy);
  const plan = Math.hypot(from[0], from[1]);
  const yaw = ((accuracy.yawDeg ?? 0) * Math.PI) / 180;
  return {
    // A tilt about both axes moves both plan coordinates by the height above the middle.
    horizontalM: Math.hypot(
      Math.sqrt(planTrace(c)),
      accuracy.horizontalM ?? 0,
      s * plan,
      yaw * plan,
      tilt * Math.SQRT2 * from[2],
    ),
    verticalM: Math.hypot(Math.sqrt(c[5]), accuracy.verticalM ?? 0, s * from[2], tilt * plan),
  };
}

/** Two edges of the closed outline cross or touch apart from their shared corner, or a corner is there twice. Plan coordinates. */
export function crossesItself(outline: readonly Vec2[]): boolean {
  const n = outline.length;
  const at = (i: number): Vec2 => outline[i % n] ?? [Number.NaN, Number.NaN];
  for (let i = 0; i < n; i += 1) {
    const [a, b] = [at(i), at(i + 1)];
    if (a[0] === b[0] && a[1] === b[1]) return true;
    // An edge that goes straight back over the one before.
    const c = at(i + 2);
    if (n > 2 && turn(a, b, c) === 0 && (c[0] - b[0]) * (b[0] - a[0]) + (c[1] - b[1]) * (b[1] - a[1]) < 0) return true;
    for (let j = i + 2; j < n; j += 1) {
      if (i === 0 && j === n - 1) continue;
      if (meet(a, b, at(j), at(j + 1))) return true;
    }
  }
  return false;
}

/** Sign of the turn from ab to c: 1 to the left, -1 to the right, 0 straight. */
function turn(a: Vec2, b: Vec2, c: Vec2): number {
  return Math.sign((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

function within(a: Vec2, b: Vec2, p: Vec2): boolean {
  return (
    Math.min(a[0], b[0]) <= p[0] &&
    p[0] <= Math.max(a[0], b[0]) &&
    Math.min(a[1], b[1]) <= p[1] &&
    p[1] <= Math.max(a[1], b[1])
  );
}

function meet(a: Vec2, b: Vec2, c: Vec2, d: Vec2): boolean {
  const [abc, abd, cda, cdb] = [turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)];
  if (abc !== abd && cda !== cdb && abc * abd <= 0 && cda * cdb <= 0) return true;
  return (
    (abc === 0 && within(a, b, c)) ||
    (abd === 0 && within(a, b, d)) ||
    (cda === 0 && within(c, d, a)) ||
    (cdb === 0 && within(c, d, b))
  );
}

/** Middle of the corners in plan. */
export function middleInPlan(points: readonly Vec3[]): Vec2 {
  const n = Math.max(1, points.length);
  return [points.reduce((sum, p) => sum + p[0], 0) / n, points.reduce((sum, p) => sum + p[1], 0) / n];
}
