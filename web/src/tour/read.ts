// Reads tour.json for editing: everything must be known and right, because what is not understood would be lost when it is saved.
import { asInteger, asObject } from "../base/check.js";
import { TOUR_VERSION } from "./limits.js";
import { readParts, STRICT } from "./read_v1.js";
import { checkReferences } from "./references.js";
import type { Tour } from "./types.js";

/** Throws CheckError with the path of the field. */
export function readTour(value: unknown): Tour {
  const root = asObject(value, "");
  asInteger(root.version, "version", TOUR_VERSION, TOUR_VERSION);
  const tour = readParts(root, STRICT);
  checkReferences(tour);
  return tour;
}
