// Changes of labels, markers and models. Each returns a new tour, or the given one itself when nothing changes.
import { CheckError } from "../base/check.js";
import type { Vec3 } from "../base/vec.js";
import { type NamedAsset, withAsset, withoutUnusedAssets } from "./edit_assets.js";
import { freshId } from "./ids.js";
import { MOST_THINGS, SCALE } from "./limits.js";
import { replaced, without } from "./lists.js";
import { same } from "./same.js";
import { type Label, type Marker, type Model, stopOf, type Thing, type Tour } from "./types.js";

export function thingOf(tour: Tour, id: string | null): Thing | null {
  return tour.things.find((thing) => thing.id === id) ?? null;
}

export function newLabel(tour: Tour, text: string, at: Vec3): Label {
  return { id: freshId(tour, "label"), kind: "label", at, text, stops: null };
}

export function newMarker(tour: Tour, text: string, at: Vec3, to: string | null): Marker {
  return { id: freshId(tour, "marker"), kind: "marker", at, text, to, stops: null };
}

/** Named after its file, in the file's own size. */
export function newModel(tour: Tour, name: string, at: Vec3, asset: string): Model {
  return { id: freshId(tour, "model"), kind: "model", at, name, yawDeg: 0, scale: 1, asset, stops: null };
}

/** Throws CheckError when there are too many, or when a model comes without its file. */
export function addThing(tour: Tour, thing: Thing, asset?: NamedAsset): Tour {
  if (tour.things.length >= MOST_THINGS) throw new CheckError("things", `a tour has at most ${MOST_THINGS}`);
  const listed = asset === undefined ? tour : withAsset(tour, asset);
  if (thing.kind === "model" && !listed.assets.has(thing.asset)) {
    throw new CheckError("assets", "the model's file is not listed");
  }
  return withoutUnusedAssets({ ...listed, things: [...listed.things, thing] });
}

export function removeThing(tour: Tour, id: string): Tour {
  const things = without(tour.things, (thing) => thing.id === id);
  return things === tour.things ? tour : withoutUnusedAssets({ ...tour, things });
}

export function moveThing(tour: Tour, id: string, at: Vec3): Tour {
  return withThing(tour, id, (thing) => ({ ...thing, at }));
}

/** The text of a label or marker, the name of a model. */
export function renameThing(tour: Tour, id: string, name: string): Tour {
  return withThing(tour, id, (thing) => (thing.kind === "model" ? { ...thing, name } : { ...thing, text: name }));
}

/** Models only; within the limits of the format. */
export function scaleThing(tour: Tour, id: string, scale: number): Tour {
  if (!(scale > 0)) return tour;
  const within = Math.min(SCALE.most, Math.max(SCALE.least, scale));
  return withThing(tour, id, (thing) => (thing.kind === "model" ? { ...thing, scale: within } : thing));
}

/** Models only: clockwise from north, made 0 to 360. */
export function turnThing(tour: Tour, id: string, yawDeg: number): Tour {
  if (!Number.isFinite(yawDeg)) return tour;
  const within = ((yawDeg % 360) + 360) % 360;
  return withThing(tour, id, (thing) => (thing.kind === "model" ? { ...thing, yawDeg: within } : thing));
}

/** Markers only. A stop that is not there changes nothing. */
export function setTarget(tour: Tour, id: string, to: string | null): Tour {
  if (to !== null && stopOf(tour, to) === null) return tour;
  return withThing(tour, id, (thing) => (thing.kind === "marker" ? { ...thing, to } : thing));
}

/** Null: always. Stops that are not there are left out. */
export function showAtStops(tour: Tour, id: string, stops: readonly string[] | null): Tour {
  const known = stops?.filter((stop, i) => stopOf(tour, stop) !== null && stops.indexOf(stop) === i) ?? null;
  return withThing(tour, id, (thing) => ({ ...thing, stops: known }));
}

function withThing(tour: Tour, id: string, change: (thing: Thing) => Thing): Tour {
  const things = replaced(tour.things, (thing) => {
    if (thing.id !== id) return thing;
    const next = change(thing);
    return same(thing, next) ? thing : next;
  });
  return things === tour.things ? tour : { ...tour, things };
}
