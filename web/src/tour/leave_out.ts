// A tour without the pictures and models whose files are not there: found missing when the tour is read, or when they are loaded.
import { shortened } from "./read_v1.js";
import type { Stop, Tour } from "./types.js";

/** The sentences say what is left out. The same tour when nothing is. */
export function leaveOutAssets(
  tour: Tour,
  isThere: (asset: string) => boolean,
): { readonly tour: Tour; readonly missing: readonly string[] } {
  const missing: string[] = [];
  const lost = (asset: string, whose: string): boolean => {
    const known = tour.assets.get(asset);
    if (known !== undefined && isThere(asset)) return false;
    const file = known === undefined ? `${asset.slice(0, 8)}…${asset.slice(64)}` : `"${shortened(known.name)}"`;
    missing.push(`${whose} is left out: its file ${file} is missing.`);
    return true;
  };
  const stops = tour.stops.map((stop): Stop => {
    if (stop.picture === null || !lost(stop.picture, `The picture of the stop "${shortened(stop.title)}"`)) return stop;
    return { ...stop, picture: null };
  });
  const things = tour.things.filter(
    (thing) => thing.kind !== "model" || !lost(thing.asset, `The model "${shortened(thing.name)}"`),
  );
  return { tour: missing.length === 0 ? tour : { ...tour, stops, things }, missing };
}
