// Changes of the tour, and of what is open of it.
import { CheckError } from "../base/check.js";
import type { Tour } from "../tour/types.js";
import { addNotice } from "./notices.js";
import type { Store } from "./store.js";
import type { TourView } from "./tour_state.js";

export function setTourView(store: Store, patch: Partial<TourView>): void {
  store.update(({ tour }) => ({ tour: { ...tour, ...patch } }));
}

/** One undoable step. Returns false, and tells why, when it cannot be done; does nothing when the tour may not be changed. */
export function changeTour(store: Store, label: string, change: (tour: Tour) => Tour, group?: string): boolean {
  if (store.get().tour.locked !== null) return false;
  try {
    store.changeDocuments(
      label,
      (documents) => {
        const tour = change(documents.tour);
        return tour === documents.tour ? documents : { ...documents, tour };
      },
      group,
    );
    return true;
  } catch (error) {
    if (!(error instanceof CheckError)) throw error;
    addNotice(store, "error", `This cannot be added to the tour: ${error.message}.`);
    return false;
  }
}
