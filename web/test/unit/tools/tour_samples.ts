// A tour of three stops in a row, and what tests of tools need around it.
import type { AppState } from "../../../src/state/app_state.js";
import type { Store } from "../../../src/state/store.js";
import { changeTour, setTourView } from "../../../src/state/tour_changes.js";
import { addStop, changeStop, newStop, type StopChange } from "../../../src/tour/edit_stops.js";
import { TourPlayer } from "../../../src/tour/player.js";
import { EMPTY_TOUR, type Tour } from "../../../src/tour/types.js";

export const EDITOR = { documents: true, tour: true } as const;
export const VISITOR = { documents: false, tour: false } as const;

/** Ids stop-1, stop-2, stop-3 at x = 0, 10, 20, each with these changes. */
export function rowOfStops(change: StopChange = {}): Tour {
  let tour = EMPTY_TOUR;
  for (let i = 0; i < 3; i += 1) {
    const stop = newStop(tour, `Stop ${i + 1}`, { eyeEnu: [10 * i, 0, 5], rotation: [1, 0, 0, 0], fovyDeg: 50 });
    tour = changeStop(addStop(tour, stop), stop.id, change);
  }
  return tour;
}

/** As an editor has it after loading. */
export function openTour(store: Store, tour: Tour): void {
  setTourView(store, { locked: null });
  changeTour(store, "make", () => tour);
}

/** At its first stop. */
export function playing(tour: Tour): AppState["play"] {
  const player = new TourPlayer({ tour, heights: () => null, reducedMotion: () => true }, 0);
  const { pose, ...view } = player.view(0);
  return pose === null ? null : { ...view, seen: [] };
}
