// Ids of new stops and things.
import type { Tour } from "./types.js";

/** "stop-1", or the first number that is free. No two stops or things have the same. */
export function freshId(tour: Tour, prefix: "stop" | "label" | "marker" | "model"): string {
  const taken = new Set([...tour.stops, ...tour.things].map(({ id }) => id));
  for (let number = 1; ; number += 1) {
    const id = `${prefix}-${number}`;
    if (!taken.has(id)) return id;
  }
}
