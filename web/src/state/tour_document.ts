// tour.json as a document of the page: read for editing where that is allowed, else for playing.
import { CheckError, parseJson } from "../base/check.js";
import { readTour } from "../tour/read.js";
import { readTourForPlaying } from "../tour/read_for_playing.js";
import { EMPTY_TOUR, type Tour } from "../tour/types.js";
import { NO_TOUR_RIGHT, type Rights } from "./tour_state.js";

export interface SavedTour {
  readonly tour: Tour;
  /** Why it cannot be changed; null: it can. */
  readonly locked: string | null;
  readonly missing: readonly string[];
  /** It plays, but the editor does not understand all of it: saving would lose that. */
  readonly unsafe: boolean;
}

/** `text` null: there is no tour yet. Throws CheckError when it cannot even be played. */
export function readSavedTour(text: string | null, rights: Rights): SavedTour {
  const locked = rights.tour ? null : NO_TOUR_RIGHT;
  if (text === null) return { tour: EMPTY_TOUR, locked, missing: [], unsafe: false };
  const value = parseJson(text, "tour.json");
  if (!rights.tour) return { ...readTourForPlaying(value), locked, unsafe: false };
  try {
    return { tour: readTour(value), locked, missing: [], unsafe: false };
  } catch (error) {
    if (!(error instanceof CheckError)) throw error;
    return {
      ...readTourForPlaying(value),
      locked: `tour.json can be played, but not changed here: ${error.message}.`,
      unsafe: true,
    };
  }
}
