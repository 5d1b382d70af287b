// The way of the camera from one pose to another: planned once, then asked for the pose at any time. It keeps CLEARANCE_M from what is solid. Ends
// that are nearer themselves are left straight up and reached straight down. The same input gives the same route.
import type { Quat, Vec3 } from "../base/vec.js";
import { angleBetweenRad, norm, slerp, sub } from "../base/vec_math.js";
import type { Pose } from "../geo/camera.js";
import type { Heights } from "./heights.js";
import { type Place, rotationsAlong } from "./orientation.js";
import { orbitLine, type PlanLine, placeAt, straightLine } from "./plan_line.js";
import { profileAlong } from "./profile.js";
import type { Path, TourPose } from "./types.js";

interface Node extends Place {
  readonly rotation: Quat;
  readonly fovyDeg: number;
  /** Of the time that the route would take without easing, at this node. */
  readonly timeS: number;
}

export interface Route {
  readonly from: TourPose;
  readonly to: TourPose;
  /** Corners of the way of the eye, with both ends. */
  readonly points: readonly Vec3[];
  readonly lengthM: number;
  /** 0: a cut. */
  readonly durationS: number;
  /** The eye is never faster than this. */
  readonly fastestMps: number;
  readonly nodes: readonly Node[];
}

export const SHORTEST_S = 1.5;
/** Longer only by the time that turning takes. */
export const LONGEST_S = 12;
export const FASTEST_TURN_DEG_PER_S = 60;
/** What takes less is rounding. */
const LEAST_S = 1e-6;
const FASTEST_ZOOM_DEG_PER_S = 30;
const SECONDS_PER_ROOT_METRE = 0.9;
/** Greatest speed by mean speed of the easing below. */
const EASE_PEAK = 1.5;
const NODES = 96;
const RAD_PER_DEG = Math.PI / 180;

/** `heights` null: nothing is known to be in the way. */
export function planRoute(from: TourPose, to: TourPose, path: Path, heights: Heights | null): Route {
  const cut: Route = {
    from,
    to,
    points: [from.eyeEnu, to.eyeEnu],
    lengthM: 0,
    durationS: 0,
    fastestMps: 0,
    nodes: [],
  };
  if (path.kind === "jump") return cut;
  const line =
    path.kind === "orbit" ? orbitLine(from.eyeEnu, to.eyeEnu, path.about) : straightLine(from.eyeEnu, to.eyeEnu);
  const points = pointsAlong(line, from.eyeEnu, to.eyeEnu, heights, path.kind === "over" ? "over" : "lowest");
  const { places, lengthM } = placesAlong(points);
  const rotations = rotationsAlong(places, from, to, path.kind === "orbit" && lengthM > 0 ? path.about : null);
  const travelS = Math.min(LONGEST_S, SHORTEST_S + SECONDS_PER_ROOT_METRE * Math.sqrt(lengthM));
  const nodes: Node[] = [];
  places.forEach((place, i) => {
    const rotation = rotations[i] ?? from.rotation;
    const fovyDeg = from.fovyDeg + (to.fovyDeg - from.fovyDeg) * place.share;
    const before = nodes[i - 1];
    let timeS = 0;
    if (before !== undefined) {
      const turnDeg = angleBetweenRad(before.rotation, rotation) / RAD_PER_DEG;
      timeS =
        before.timeS +
        Math.hypot(
          lengthM > 0 ? (place.share - before.share) * travelS : 0,
          (EASE_PEAK * turnDeg) / FASTEST_TURN_DEG_PER_S,
          (EASE_PEAK * (fovyDeg - before.fovyDeg)) / FASTEST_ZOOM_DEG_PER_S,
        );
    }
    nodes.push({ ...place, rotation, fovyDeg, timeS });
  });
  const timeS = nodes.at(-1)?.timeS ?? 0;
  if (timeS < LEAST_S) return cut;
  return {
    from,
    to,
    points,
    lengthM,
    durationS: Math.max(SHORTEST_S, timeS),
    fastestMps: (EASE_PEAK * lengthM) / travelS,
    nodes,
  };
}

/** The pose `seconds` after the beginning; before it the first, after the end the last. */
export function poseAt(route: Route, seconds: number): Pose {
  const { from, to, nodes, durationS } = route;
  if (seconds >= durationS) return poseOf(to);
  if (!(seconds > 0)) return poseOf(from);
  const u = seconds / durationS;
  const timeS = u * u * (3 - 2 * u) * (nodes.at(-1)?.timeS ?? 0);
  let [low, high] = [0, nodes.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((nodes[middle]?.timeS ?? 0) <= timeS) low = middle;
    else high = middle;
  }
  const [a, b] = [nodes[low], nodes[high]];
  if (a === undefined || b === undefined) return poseOf(to);
  const part = b.timeS > a.timeS ? Math.min(1, Math.max(0, (timeS - a.timeS) / (b.timeS - a.timeS))) : 1;
  return {
    eyeEnu: between(a.eyeEnu, b.eyeEnu, part),
    rotation: slerp(a.rotation, b.rotation, part),
    fovyDeg: a.fovyDeg + (b.fovyDeg - a.fovyDeg) * part,
    orthoHeightM: null,
  };
}

/** A stop's pose as the viewer's camera takes it. */
export function poseOf({ eyeEnu, rotation, fovyDeg }: TourPose): Pose {
  return { eyeEnu, rotation, fovyDeg, orthoHeightM: null };
}

/** a + (b - a) * u has rounding of its own: equal coordinates must stay equal. */
function between(a: Vec3, b: Vec3, u: number): Vec3 {
  const axis = (i: 0 | 1 | 2) => (a[i] === b[i] ? a[i] : a[i] + (b[i] - a[i]) * u);
  return [axis(0), axis(1), axis(2)];
}

/** Corners of the way: those of its plan and those of its profile. */
function pointsAlong(
  line: PlanLine,
  from: Vec3,
  to: Vec3,
  heights: Heights | null,
  kind: "lowest" | "over",
): readonly Vec3[] {
  const profile = profileAlong(line, from[2], to[2], heights, kind);
  const points: Vec3[] = [];
  let next = 0;
  profile.forEach(([atM, z], i) => {
    const [beforeM, beforeZ] = profile[i - 1] ?? [0, z];
    // Corners in plan since the last one of the profile.
    for (; next < line.points.length && (line.lengthsM[next] ?? 0) < atM; next += 1) {
      const [cornerM, corner] = [line.lengthsM[next] ?? 0, line.points[next] ?? [0, 0]];
      if (cornerM <= beforeM) continue;
      points.push([corner[0], corner[1], beforeZ + ((z - beforeZ) * (cornerM - beforeM)) / (atM - beforeM)]);
    }
    const [x, y] = placeAt(line, atM);
    points.push([x, y, z]);
  });
  return [from, ...points.slice(1, -1), to];
}

/** Points of the way close enough together that the view turns little between them. */
function placesAlong(points: readonly Vec3[]): { readonly places: readonly Place[]; readonly lengthM: number } {
  const first = points[0] ?? [0, 0, 0];
  let lengthM = 0;
  points.forEach((point, i) => {
    lengthM += norm(sub(point, points[i - 1] ?? point));
  });
  if (!(lengthM > 0)) {
    // Turning on the spot.
    const places = Array.from({ length: NODES + 1 }, (_, i) => ({ eyeEnu: first, share: i / NODES }));
    return { places, lengthM: 0 };
  }
  const places: Place[] = [{ eyeEnu: first, share: 0 }];
  let doneM = 0;
  points.forEach((point, i) => {
    const before = points[i - 1];
    if (before === undefined) return;
    const pieceM = norm(sub(point, before));
    const parts = Math.max(1, Math.ceil((NODES * pieceM) / lengthM));
    for (let k = 1; k <= parts; k += 1) {
      const eyeEnu = k === parts ? point : between(before, point, k / parts);
      places.push({ eyeEnu, share: Math.min(1, (doneM + (pieceM * k) / parts) / lengthM) });
    }
    doneM += pieceM;
  });
  return { places, lengthM };
}
