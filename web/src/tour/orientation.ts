// Where the camera looks along a way. Heading, pitch and roll are interpolated each for itself: between two level cameras the shortest rotation would
// tilt the horizon. When both ends look at the same thing, the camera keeps looking at it; on an orbit it looks at the middle of the orbit.
import type { Quat, Vec3 } from "../base/vec.js";
import { add, angleBetweenRad, dot, norm, scale, slerp, sub } from "../base/vec_math.js";
import { type Angles, anglesOfPose, forward, rotationFromAngles } from "../geo/camera.js";
import type { TourPose } from "./types.js";

/** An eye on the way; `share` of its length lies behind. */
export interface Place {
  readonly eyeEnu: Vec3;
  readonly share: number;
}

const DEG_PER_RAD = 180 / Math.PI;
/** Looking steeper than this at something, the heading would swing round when one passes over it. */
const STEEPEST_LOOK_DEG = 75;
const LEAST_TARGET_M = 1;
/** The rays of both ends pass each other this near, by their length: about 3 degrees. */
const TARGET_GAP = 0.05;
/** Nearer to the common target than this share of what the ends are, one would turn too much. */
const NEAREST_SHARE = 0.4;
/** Share of an orbit in which the view turns from that of its end to the middle. */
const ORBIT_TURN = 0.3;

function wrapped(deg: number): number {
  return deg - 360 * Math.round(deg / 360);
}

function mix(a: number, b: number, u: number): number {
  return a + (b - a) * u;
}

function smooth(u: number): number {
  const t = Math.min(1, Math.max(0, u));
  return t * t * (3 - 2 * t);
}

/** Rotations at all places; those of the ends are the given ones. */
export function rotationsAlong(
  places: readonly Place[],
  from: TourPose,
  to: TourPose,
  about: Vec3 | null,
): readonly Quat[] {
  const rotations =
    about !== null
      ? aroundMiddle(places, from, to, about)
      : (towardsTarget(places, from, to) ?? betweenEnds(places, from, to));
  return rotations.map((rotation, i) => (i === 0 ? from.rotation : i === places.length - 1 ? to.rotation : rotation));
}

function betweenEnds(places: readonly Place[], from: TourPose, to: TourPose): readonly Quat[] {
  const [a, b] = [anglesOfPose(from.rotation), anglesOfPose(to.rotation)];
  const [yaw, roll] = [wrapped(b.yawDeg - a.yawDeg), wrapped(b.rollDeg - a.rollDeg)];
  const byAngles = ({ share }: Place) =>
    rotationFromAngles({
      yawDeg: a.yawDeg + yaw * share,
      pitchDeg: mix(a.pitchDeg, b.pitchDeg, share),
      rollDeg: a.rollDeg + roll * share,
    });
  // Straight down, heading and roll are one: between two such views the angles can make a turn that is none.
  const shortest = angleBetweenRad(from.rotation, to.rotation);
  const turn = Math.hypot(yaw, b.pitchDeg - a.pitchDeg, roll) / DEG_PER_RAD;
  if (turn > 2 * shortest + 0.3) return places.map(({ share }) => slerp(from.rotation, to.rotation, share));
  return places.map(byAngles);
}

/** Heading and pitch from a place to another; the heading of what is straight below is `otherwiseDeg`. */
function anglesTo(eye: Vec3, target: Vec3, otherwiseDeg: number): Pick<Angles, "yawDeg" | "pitchDeg"> {
  const d = sub(target, eye);
  const across = Math.hypot(d[0], d[1]);
  return {
    yawDeg: across > 1e-9 * (1 + norm(d)) ? Math.atan2(d[0], d[1]) * DEG_PER_RAD : otherwiseDeg,
    pitchDeg: Math.atan2(d[2], across) * DEG_PER_RAD,
  };
}

/** Null: the ends look at nothing in common, or one would come too near or too much above it. */
function towardsTarget(places: readonly Place[], from: TourPose, to: TourPose): readonly Quat[] | null {
  const targets = commonTarget(from, to);
  if (targets === null) return null;
  const [first, last] = targets;
  const nearest = NEAREST_SHARE * Math.min(norm(sub(first, from.eyeEnu)), norm(sub(last, to.eyeEnu)));
  const [a, b] = [anglesOfPose(from.rotation), anglesOfPose(to.rotation)];
  const roll = wrapped(b.rollDeg - a.rollDeg);
  const rotations: Quat[] = [];
  for (const { eyeEnu, share } of places) {
    const target = add(first, scale(sub(last, first), share));
    const { yawDeg, pitchDeg } = anglesTo(eyeEnu, target, 0);
    if (norm(sub(target, eyeEnu)) < nearest || Math.abs(pitchDeg) > STEEPEST_LOOK_DEG) return null;
    rotations.push(rotationFromAngles({ yawDeg, pitchDeg, rollDeg: a.rollDeg + roll * share }));
  }
  return rotations;
}

/** What both look at, as the nearest points of the two rays; null: nothing. */
function commonTarget(from: TourPose, to: TourPose): readonly [Vec3, Vec3] | null {
  const [u, v] = [forward(from.rotation), forward(to.rotation)];
  const between = sub(from.eyeEnu, to.eyeEnu);
  const cosine = dot(u, v);
  const sineSquare = 1 - cosine * cosine;
  if (sineSquare < 1e-6) return null;
  const [d, e] = [dot(u, between), dot(v, between)];
  const s = (cosine * e - d) / sineSquare;
  const t = (e - cosine * d) / sineSquare;
  if (s < LEAST_TARGET_M || t < LEAST_TARGET_M) return null;
  const first = add(from.eyeEnu, scale(u, s));
  const last = add(to.eyeEnu, scale(v, t));
  return norm(sub(first, last)) <= TARGET_GAP * Math.min(s, t) ? [first, last] : null;
}

/** Looks at the middle; at each end by the difference there is to the pose. */
function aroundMiddle(places: readonly Place[], from: TourPose, to: TourPose, about: Vec3): readonly Quat[] {
  const [a, b] = [anglesOfPose(from.rotation), anglesOfPose(to.rotation)];
  const looks: Pick<Angles, "yawDeg" | "pitchDeg">[] = [];
  // Straight above the middle the heading is that of the next place, or of the one before.
  const far = places.find(({ eyeEnu }) => Math.hypot(eyeEnu[0] - about[0], eyeEnu[1] - about[1]) > 1e-6);
  let heading = far === undefined ? a.yawDeg : anglesTo(far.eyeEnu, about, a.yawDeg).yawDeg;
  for (const { eyeEnu } of places) {
    const look = anglesTo(eyeEnu, about, heading);
    heading = look.yawDeg;
    looks.push(look);
  }
  const [first, last] = [looks[0], looks.at(-1)];
  if (first === undefined || last === undefined) return [];
  const difference = (pose: Angles, look: Pick<Angles, "yawDeg" | "pitchDeg">) => ({
    yawDeg: wrapped(pose.yawDeg - look.yawDeg),
    pitchDeg: pose.pitchDeg - look.pitchDeg,
    rollDeg: pose.rollDeg,
  });
  const [atStart, atEnd] = [difference(a, first), difference(b, last)];
  return places.map(({ share }, i) => {
    const look = looks[i] ?? first;
    const start = 1 - smooth(share / ORBIT_TURN);
    const end = 1 - smooth((1 - share) / ORBIT_TURN);
    return rotationFromAngles({
      yawDeg: look.yawDeg + start * atStart.yawDeg + end * atEnd.yawDeg,
      pitchDeg: Math.min(90, Math.max(-90, look.pitchDeg + start * atStart.pitchDeg + end * atEnd.pitchDeg)),
      rollDeg: start * atStart.rollDeg + end * atEnd.rollDeg,
    });
  });
}
