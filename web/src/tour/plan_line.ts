// The way between two poses as it looks from above: a polyline with its length as the parameter.
import type { Vec2, Vec3 } from "../base/vec.js";

export interface PlanLine {
  readonly points: readonly Vec2[];
  /** Length from the beginning to each point, metres; never falls. */
  readonly lengthsM: readonly number[];
  readonly lengthM: number;
}

const ORBIT_STEP_RAD = Math.PI / 90;
/** A radius that gives no direction. */
const SHORTEST_RADIUS_M = 1e-6;

function lineThrough(points: readonly Vec2[]): PlanLine {
  const lengthsM: number[] = [];
  let lengthM = 0;
  points.forEach((point, i) => {
    const before = points[i - 1] ?? point;
    lengthM += Math.hypot(point[0] - before[0], point[1] - before[1]);
    lengthsM.push(lengthM);
  });
  return { points, lengthsM, lengthM };
}

export function straightLine(from: Vec3, to: Vec3): PlanLine {
  return lineThrough([
    [from[0], from[1]],
    [to[0], to[1]],
  ]);
}

/** Around `about` the shorter way, counter-clockwise when both are as short; the distance changes evenly with the angle. */
export function orbitLine(from: Vec3, to: Vec3, about: Vec3): PlanLine {
  const [ax, ay] = [from[0] - about[0], from[1] - about[1]];
  const [bx, by] = [to[0] - about[0], to[1] - about[1]];
  const [near, far] = [Math.hypot(ax, ay), Math.hypot(bx, by)];
  // From above the middle one leaves, or gets there, on the bearing of the other end.
  const angle = near > SHORTEST_RADIUS_M ? Math.atan2(ay, ax) : Math.atan2(by, bx);
  const turn =
    near > SHORTEST_RADIUS_M && far > SHORTEST_RADIUS_M ? Math.atan2(ax * by - ay * bx, ax * bx + ay * by) : 0;
  const signed = turn === -Math.PI ? Math.PI : turn;
  const parts = Math.max(1, Math.ceil(Math.abs(signed) / ORBIT_STEP_RAD));
  const points: Vec2[] = [[from[0], from[1]]];
  for (let i = 1; i < parts; i += 1) {
    const u = i / parts;
    const radius = near + (far - near) * u;
    points.push([about[0] + radius * Math.cos(angle + signed * u), about[1] + radius * Math.sin(angle + signed * u)]);
  }
  points.push([to[0], to[1]]);
  return lineThrough(points);
}

/** The place at this length; the ends beyond them. */
export function placeAt(line: PlanLine, lengthM: number): Vec2 {
  const { points, lengthsM } = line;
  let [low, high] = [0, lengthsM.length - 1];
  // The last point that is not beyond the length.
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if ((lengthsM[middle] ?? 0) <= lengthM) low = middle;
    else high = middle - 1;
  }
  const a = points[low] ?? [0, 0];
  const b = points[low + 1];
  if (b === undefined) return a;
  const [from, to] = [lengthsM[low] ?? 0, lengthsM[low + 1] ?? 0];
  const u = Math.max(0, (lengthM - from) / (to - from));
  return [a[0] + (b[0] - a[0]) * u, a[1] + (b[1] - a[1]) * u];
}
