// Changes of a tour's title and stops. Each returns a new tour, or the given one itself when nothing changes, so that undo can keep tours as they were.
// Ids that are not there change nothing.
import { CheckError } from "../base/check.js";
import { type NamedAsset, withAsset, withoutUnusedAssets } from "./edit_assets.js";
import { freshId } from "./ids.js";
import { MOST_BRANCHES, MOST_STOPS } from "./limits.js";
import { inserted, moved, replaced, without } from "./lists.js";
import { same } from "./same.js";
import { type Branch, type Next, type Stop, stopOf, type Thing, type Tour, type TourPose } from "./types.js";

export type StopChange = Partial<Omit<Stop, "id" | "picture" | "branches">>;

export function setTitle(tour: Tour, title: string): Tour {
  return tour.title === title ? tour : { ...tour, title };
}

/** Null: the tour begins at the first stop of the list. */
export function setStart(tour: Tour, start: string | null): Tour {
  return tour.start === start || (start !== null && stopOf(tour, start) === null) ? tour : { ...tour, start };
}

/** A stop with a fresh id, from which the next one of the list follows. It is not in the tour yet. */
export function newStop(tour: Tour, title: string, { eyeEnu, rotation, fovyDeg }: TourPose): Stop {
  return {
    id: freshId(tour, "stop"),
    title,
    text: "",
    picture: null,
    link: null,
    // What else a pose of the viewer has does not belong here.
    pose: { eyeEnu, rotation, fovyDeg },
    exposureStops: null,
    layers: null,
    measurements: [],
    pauseS: 5,
    next: { to: null, path: { kind: "direct" } },
    branches: [],
  };
}

/** Throws CheckError when there are too many. */
export function addStop(tour: Tour, stop: Stop, place = tour.stops.length): Tour {
  if (tour.stops.length >= MOST_STOPS) throw new CheckError("stops", `a tour has at most ${MOST_STOPS}`);
  return { ...tour, stops: inserted(tour.stops, stop, place) };
}

/** All that leads to it goes too: branches, the targets of markers. A stop that named it as its next is followed by the next one of the list. */
export function removeStop(tour: Tour, id: string): Tour {
  if (stopOf(tour, id) === null) return tour;
  const stops = without(tour.stops, (stop) => stop.id === id).map((stop): Stop => {
    const branches = without(stop.branches, ({ to }) => to === id);
    const next = stop.next?.to === id ? { ...stop.next, to: null } : stop.next;
    return branches === stop.branches && next === stop.next ? stop : { ...stop, branches, next };
  });
  const things = tour.things.flatMap((thing): Thing[] => {
    const at = thing.stops === null ? null : without(thing.stops, (stop) => stop === id);
    // What was shown only there would be shown nowhere.
    if (at?.length === 0 && thing.stops?.length !== 0) return [];
    if (thing.kind === "marker" && thing.to === id) return [{ ...thing, to: null, stops: at }];
    return [at === thing.stops ? thing : { ...thing, stops: at }];
  });
  const start = tour.start === id ? null : tour.start;
  return withoutUnusedAssets({ ...tour, start, stops, things });
}

/** Only the order of the list changes. */
export function moveStop(tour: Tour, id: string, place: number): Tour {
  const from = tour.stops.findIndex((stop) => stop.id === id);
  const stops = moved(tour.stops, from, Math.min(tour.stops.length - 1, Math.max(0, place)));
  return stops === tour.stops ? tour : { ...tour, stops };
}

export function changeStop(tour: Tour, id: string, change: StopChange): Tour {
  return withStop(tour, id, (stop) => ({ ...stop, ...change }));
}

export function setPicture(tour: Tour, id: string, picture: NamedAsset | null): Tour {
  if (stopOf(tour, id) === null) return tour;
  const listed = picture === null ? tour : withAsset(tour, picture);
  return withoutUnusedAssets(withStop(listed, id, (stop) => ({ ...stop, picture: picture?.file ?? null })));
}

/** A target that is not there changes nothing. */
export function setNext(tour: Tour, id: string, next: Next | null): Tour {
  if (next !== null && next.to !== null && stopOf(tour, next.to) === null) return tour;
  return changeStop(tour, id, { next });
}

/** Throws CheckError when there are too many. */
export function addBranch(tour: Tour, id: string, branch: Branch): Tour {
  if (stopOf(tour, branch.to) === null) return tour;
  return withStop(tour, id, (stop) => {
    if (stop.branches.length >= MOST_BRANCHES) {
      throw new CheckError("branches", `a stop has at most ${MOST_BRANCHES}`);
    }
    return { ...stop, branches: [...stop.branches, branch] };
  });
}

export function changeBranch(tour: Tour, id: string, index: number, change: Partial<Branch>): Tour {
  if (change.to !== undefined && stopOf(tour, change.to) === null) return tour;
  return withStop(tour, id, (stop) => ({
    ...stop,
    branches: stop.branches.map((branch, i) => (i === index ? { ...branch, ...change } : branch)),
  }));
}

export function moveBranch(tour: Tour, id: string, from: number, to: number): Tour {
  return withStop(tour, id, (stop) => ({ ...stop, branches: moved(stop.branches, from, to) }));
}

export function removeBranch(tour: Tour, id: string, index: number): Tour {
  return withStop(tour, id, (stop) => ({ ...stop, branches: stop.branches.filter((_, i) => i !== index) }));
}

function withStop(tour: Tour, id: string, change: (stop: Stop) => Stop): Tour {
  const stops = replaced(tour.stops, (stop) => {
    if (stop.id !== id) return stop;
    const next = change(stop);
    return same(stop, next) ? stop : next;
  });
  return stops === tour.stops ? tour : { ...tour, stops };
}
