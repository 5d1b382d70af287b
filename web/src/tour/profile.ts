// Height along a way: the string that is pulled tight over all barriers, with its corners rounded where that keeps the clearance. Points are
// (length in plan, z).
import type { Vec2 } from "../base/vec.js";
import { type Barrier, barriersAlong, keepsClear } from "./clearance.js";
import { type Heights, NOTHING } from "./heights.js";
import type { PlanLine } from "./plan_line.js";

/** The string is pulled this much higher than the barriers, so that corners can be rounded below it. Less near the ends, which stay where they are. */
const LIFT_M = 0.5;
const LIFT_FULL_AFTER_M = 4;
/** Where a way over the highest has reached its height. */
const RISEN_AT = 0.25;
const LEAST_CORNER_RAD = Math.PI / 180;
const ROUNDINGS = 7;
const LEAST_ROUNDING_M = 0.05;
const ROUND_STEP_RAD = Math.PI / 36;

export type ProfileKind = "lowest" | "over";

export function profileAlong(
  line: PlanLine,
  fromZ: number,
  toZ: number,
  heights: Heights | null,
  kind: ProfileKind,
): readonly Vec2[] {
  const length = line.lengthM;
  const straight: readonly Vec2[] = [
    [0, fromZ],
    [length, toZ],
  ];
  if (!(length > 0)) return straight;
  if (kind === "lowest" && (heights === null || keepsClear(line, heights, [0, fromZ], [length, toZ]))) return straight;
  const baseZ = (at: number) => fromZ + ((toZ - fromZ) * at) / length;
  const barriers = heights === null ? [] : barriersAlong(line, heights, baseZ);
  const string = tautString(barriers, [0, raised(fromZ, barriers[0])], [length, raised(toZ, barriers.at(-1))], kind);
  // An end that is too near itself is left straight up and reached straight down.
  const whole: Vec2[] = [...string];
  if (string[0]?.[1] !== fromZ) whole.unshift([0, fromZ]);
  if (string.at(-1)?.[1] !== toZ) whole.push([length, toZ]);
  return rounded(whole, (a, b) => heights === null || keepsClear(line, heights, a, b));
}

function raised(z: number, barrier: Barrier | undefined): number {
  return barrier === undefined || barrier.z <= z ? z : barrier.z + LIFT_M;
}

/** From end to end above all barriers, as short as possible: it bends only downwards, so it is a convex hull. */
function tautString(barriers: readonly Barrier[], from: Vec2, to: Vec2, kind: ProfileKind): Vec2[] {
  const length = to[0];
  const knots: Vec2[] = [from];
  let highest = Math.max(from[1], to[1]);
  barriers.forEach(({ fromM, z }, i) => {
    const top = Math.max(z, barriers[i - 1]?.z ?? NOTHING);
    if (i === 0 || top === NOTHING) return;
    const lifted = top + LIFT_M * Math.min(1, fromM / LIFT_FULL_AFTER_M, (length - fromM) / LIFT_FULL_AFTER_M);
    highest = Math.max(highest, lifted);
    knots.push([fromM, lifted]);
  });
  if (kind === "over") {
    knots.push([RISEN_AT * length, highest], [(1 - RISEN_AT) * length, highest]);
    knots.sort((a, b) => a[0] - b[0]);
  }
  knots.push(to);
  const hull: Vec2[] = [];
  for (const knot of knots) {
    for (;;) {
      const [a, b] = [hull.at(-2), hull.at(-1)];
      if (a === undefined || b === undefined || isAbove(a, b, knot)) break;
      hull.pop();
    }
    hull.push(knot);
  }
  return hull;
}

/** Whether b is above the line from a to c. */
function isAbove(a: Vec2, b: Vec2, c: Vec2): boolean {
  return (b[1] - a[1]) * (c[0] - a[0]) > (c[1] - a[1]) * (b[0] - a[0]);
}

/** Each corner becomes as wide a curve as is clear, at most to the middles of its edges. */
function rounded(points: readonly Vec2[], isClear: (a: Vec2, b: Vec2) => boolean): readonly Vec2[] {
  const result: Vec2[] = [];
  points.forEach((corner, i) => {
    const [before, after] = [points[i - 1], points[i + 1]];
    if (before === undefined || after === undefined) result.push(corner);
    else result.push(...roundedCorner(before, corner, after, isClear));
  });
  // Two curves can meet in the middle of an edge.
  return result.filter(([at, z], i) => i === 0 || at !== result[i - 1]?.[0] || z !== result[i - 1]?.[1]);
}

function roundedCorner(
  before: Vec2,
  corner: Vec2,
  after: Vec2,
  isClear: (a: Vec2, b: Vec2) => boolean,
): readonly Vec2[] {
  const into: Vec2 = [corner[0] - before[0], corner[1] - before[1]];
  const out: Vec2 = [after[0] - corner[0], after[1] - corner[1]];
  const [lengthIn, lengthOut] = [Math.hypot(...into), Math.hypot(...out)];
  const angle = Math.abs(Math.atan2(into[0] * out[1] - into[1] * out[0], into[0] * out[0] + into[1] * out[1]));
  if (angle < LEAST_CORNER_RAD) return [corner];
  const parts = Math.max(4, Math.ceil(angle / ROUND_STEP_RAD));
  let radius = Math.min(lengthIn, lengthOut) / 2;
  for (let attempt = 0; attempt < ROUNDINGS && radius >= LEAST_ROUNDING_M; attempt += 1, radius /= 2) {
    const a: Vec2 = [corner[0] - (into[0] / lengthIn) * radius, corner[1] - (into[1] / lengthIn) * radius];
    const b: Vec2 = [corner[0] + (out[0] / lengthOut) * radius, corner[1] + (out[1] / lengthOut) * radius];
    const curve: Vec2[] = [];
    for (let k = 0; k <= parts; k += 1) curve.push(onCurve(a, corner, b, k / parts));
    if (curve.every((point, k) => k === 0 || isClear(curve[k - 1] ?? point, point))) return curve;
  }
  return [corner];
}

/** Quadratic Bezier curve; the length never falls along it, as it does not along its control points. */
function onCurve(a: Vec2, b: Vec2, c: Vec2, u: number): Vec2 {
  const [p, q, r] = [(1 - u) * (1 - u), 2 * u * (1 - u), u * u];
  return [p * a[0] + q * b[0] + r * c[0], p * a[1] + q * b[1] + r * c[1]];
}
