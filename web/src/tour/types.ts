// A tour: stops with their poses and texts, ways between them, and things that stand in the scene. Immutable; tour.json is its file. Places are ENU of
// the main project in metres, rotations cam_from_enu (w, x, y, z) with COLMAP's camera axes.
import type { Vec3 } from "../base/vec.js";
import type { Pose } from "../geo/camera.js";

/** Always perspective. */
export type TourPose = Pick<Pose, "eyeEnu" | "rotation" | "fovyDeg">;

/** How one gets from a pose to the next. `direct` rises only over what is in the way, `over` over the highest between both, `jump` cuts. */
export type Path =
  | { readonly kind: "direct" }
  | { readonly kind: "orbit"; readonly about: Vec3 }
  | { readonly kind: "over" }
  | { readonly kind: "jump" };

export interface Next {
  /** Id of a stop; null: the next in the list, none after the last. */
  readonly to: string | null;
  readonly path: Path;
}

export interface Branch {
  readonly to: string;
  readonly label: string;
  readonly path: Path;
}

export interface WebLink {
  readonly label: string;
  readonly url: string;
}

/** Those of the viewer that a stop may switch. */
export const LAYER_NAMES = [
  "surface",
  "exact",
  "buildings",
  "blocks",
  "cameras",
  "points",
  "contours",
  "errorMap",
  "measurements",
  "controlPoints",
] as const;
export type LayerName = (typeof LAYER_NAMES)[number];
export type LayerChoice = { readonly [name in LayerName]?: boolean };

export interface Stop {
  readonly id: string;
  readonly title: string;
  readonly text: string;
  /** Name of an asset, png or jpg. */
  readonly picture: string | null;
  readonly link: WebLink | null;
  readonly pose: TourPose;
  /** Null: as the viewer has it. */
  readonly exposureStops: number | null;
  /** Layers that are not named stay as they are. */
  readonly layers: LayerChoice | null;
  /** Ids of measurements to show. */
  readonly measurements: readonly string[];
  /** How long autoplay stays here. */
  readonly pauseS: number;
  /** Null: the tour ends here. */
  readonly next: Next | null;
  readonly branches: readonly Branch[];
}

interface ThingBase {
  readonly id: string;
  readonly at: Vec3;
  /** Ids of the stops where it is shown; null: always. */
  readonly stops: readonly string[] | null;
}
export interface Label extends ThingBase {
  readonly kind: "label";
  readonly text: string;
}
/** A hot spot when it leads to a stop. */
export interface Marker extends ThingBase {
  readonly kind: "marker";
  readonly text: string;
  readonly to: string | null;
}
export interface Model extends ThingBase {
  readonly kind: "model";
  readonly name: string;
  /** Clockwise from north. */
  readonly yawDeg: number;
  /** 1: the metres of the file. */
  readonly scale: number;
  /** Name of an asset, glb. */
  readonly asset: string;
}
export type Thing = Label | Marker | Model;

export interface Asset {
  /** The file's name when it was uploaded. */
  readonly name: string;
  readonly bytes: number;
}

export interface Tour {
  readonly title: string;
  /** Id of a stop; null: the first. */
  readonly start: string | null;
  readonly stops: readonly Stop[];
  readonly things: readonly Thing[];
  /** By the name of the asset: SHA-256 of its bytes, a point, its type. */
  readonly assets: ReadonlyMap<string, Asset>;
}

export const EMPTY_TOUR: Tour = { title: "", start: null, stops: [], things: [], assets: new Map() };

export function stopOf(tour: Tour, id: string | null): Stop | null {
  return tour.stops.find((stop) => stop.id === id) ?? null;
}

export function firstStop(tour: Tour): Stop | null {
  return stopOf(tour, tour.start) ?? tour.stops[0] ?? null;
}

/** Where `next` leads from this stop; null: the tour ends here. */
export function followingStop(tour: Tour, stop: Stop): Stop | null {
  if (stop.next === null) return null;
  if (stop.next.to !== null) return stopOf(tour, stop.next.to);
  const at = tour.stops.findIndex(({ id }) => id === stop.id);
  return at < 0 ? null : (tour.stops[at + 1] ?? null);
}

/** Names of the assets that stops and things need. */
export function usedAssets(tour: Tour): ReadonlySet<string> {
  const used = new Set<string>();
  for (const { picture } of tour.stops) if (picture !== null) used.add(picture);
  for (const thing of tour.things) if (thing.kind === "model") used.add(thing.asset);
  return used;
}
