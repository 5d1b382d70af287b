// What parts of a tour say of each other: ids of stops, names of assets. A tour is saved only when all are there.
import { CheckError } from "../base/check.js";
import type { Tour } from "./types.js";

/** Throws CheckError at the first that leads nowhere. */
export function checkReferences(tour: Tour): void {
  const stops = new Set(tour.stops.map(({ id }) => id));
  const stop = (id: string | null, path: string) => {
    if (id !== null && !stops.has(id)) throw new CheckError(path, `there is no stop "${id}"`);
  };
  const asset = (name: string | null, path: string) => {
    if (name !== null && !tour.assets.has(name)) throw new CheckError(path, 'the file is not listed in "assets"');
  };
  stop(tour.start, "start");
  tour.stops.forEach(({ picture, next, branches }, i) => {
    asset(picture, `stops[${i}].picture`);
    stop(next?.to ?? null, `stops[${i}].next.to`);
    branches.forEach(({ to }, k) => {
      stop(to, `stops[${i}].branches[${k}].to`);
    });
  });
  tour.things.forEach((thing, i) => {
    thing.stops?.forEach((id, k) => {
      stop(id, `things[${i}].stops[${k}]`);
    });
    if (thing.kind === "marker") stop(thing.to, `things[${i}].to`);
    if (thing.kind === "model") asset(thing.asset, `things[${i}].asset`);
  });
}
