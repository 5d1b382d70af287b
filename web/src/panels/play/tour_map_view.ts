// Where things are on the small map of a tour: north is up, its picture is square. Pure.
import type { Vec2, Vec3 } from "../../base/vec.js";
import type { GroundMap } from "../../state/tour_state.js";

/** The part of the ground that is shown, as a view box of SVG whose y grows to the south. */
export interface MapBox {
  readonly left: number;
  readonly top: number;
  readonly sideM: number;
}

const LEAST_SIDE_M = 40;
/** Kept free around the outermost stops, of the side. */
const MARGIN = 0.15;
/** A picture of the ground that is larger than this many times the way is shown in part. */
const WIDE = 4;

/** Holds all the places; null without any. */
export function mapBox(places: readonly Vec3[]): MapBox | null {
  const first = places[0];
  if (first === undefined) return null;
  let [minX, maxX, minY, maxY] = [first[0], first[0], first[1], first[1]];
  for (const [x, y] of places) {
    minX = Math.min(minX, x);
    maxX = Math.max(maxX, x);
    minY = Math.min(minY, y);
    maxY = Math.max(maxY, y);
  }
  const sideM = Math.max(LEAST_SIDE_M, Math.max(maxX - minX, maxY - minY) / (1 - 2 * MARGIN));
  return { left: (minX + maxX - sideM) / 2, top: -(minY + maxY) / 2 - sideM / 2, sideM };
}

/** Shares of the map's width and height from its upper left corner. */
export function onMap({ left, top, sideM }: MapBox, [x, y]: Vec3): Vec2 {
  return [(x - left) / sideM, (-y - top) / sideM];
}

/** Kept at the edge when it is outside. */
export function withinMap([x, y]: Vec2): Vec2 {
  const clamp = (value: number) => Math.min(0.97, Math.max(0.03, value));
  return [clamp(x), clamp(y)];
}

/** Holds the stops, and all of the ground unless they would shrink to a spot in it. */
export function tourBox(stops: readonly Vec3[], ground: GroundMap | null): MapBox | null {
  const own = mapBox(stops);
  if (own === null || ground === null) return own;
  const { corner, across, down } = ground;
  const corners = [0, 1, 2, 3].map((i): Vec3 => {
    const [u, v] = [i % 2, i >> 1];
    return [corner[0] + u * across[0] + v * down[0], corner[1] + u * across[1] + v * down[1], 0];
  });
  const all = mapBox([...stops, ...corners]);
  return all !== null && all.sideM <= WIDE * own.sideM ? all : own;
}

/** The transform of SVG that lays the unit square with the picture where it belongs. */
export function pictureTransform({ corner, across, down }: GroundMap): string {
  return `matrix(${across[0]} ${-across[1]} ${down[0]} ${-down[1]} ${corner[0]} ${-corner[1]})`;
}
