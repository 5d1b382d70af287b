// Two windows that change one tour: nothing is overwritten, nothing is joined. The second one is told and decides; until then its changes stay in the page.
import { errorText } from "../base/abort.js";
import type { LoadedDocument } from "../protocol/documents_client.js";
import type { Documents } from "../state/app_state.js";
import { addNotice, removeNotice } from "../state/notices.js";
import type { Store } from "../state/store.js";
import { setTourView } from "../state/tour_changes.js";
import { readSavedTour } from "../state/tour_document.js";

const TEXT =
  "Another window has saved the tour meanwhile. Your changes are only in this page: take the other version, or keep yours, which then replaces it.";
const TAKEN = "The other version of the tour was taken. Undo brings your own back.";

export interface ConflictUser {
  load(): Promise<LoadedDocument>;
  /** The file has this content, which is that part of the documents; null: of none that this page has. */
  settled(tag: string | null, documents: Documents | null): void;
}

export class TourConflict {
  private readonly store: Store;
  private readonly user: ConflictUser;
  private notice: number | null = null;
  /** The version that the person was told of. */
  private tag: string | null = null;

  constructor(store: Store, user: ConflictUser) {
    this.store = store;
    this.user = user;
  }

  get open(): boolean {
    return this.store.get().tour.conflict;
  }

  begin(tag: string | null): void {
    this.end();
    this.tag = tag;
    setTourView(this.store, { conflict: true });
    this.notice = addNotice(this.store, "error", TEXT, [
      { label: "Take the other version", command: "tour.takeOther" },
      { label: "Keep mine", command: "tour.keepMine" },
    ]);
  }

  async takeOther(): Promise<void> {
    if (!this.open) return;
    const { store } = this;
    try {
      const { text, tag } = await this.user.load();
      const { tour, locked, unsafe } = readSavedTour(text, store.get().rights);
      if (unsafe) throw new Error(locked ?? "it is not understood here");
      if (!this.open) return;
      this.end();
      store.changeDocuments("take the tour of the other window", (documents) => ({ ...documents, tour }));
      this.user.settled(tag, store.get().documents);
      addNotice(store, "info", TAKEN);
    } catch (error) {
      addNotice(store, "error", `The other version of the tour could not be taken: ${errorText(error)}`);
    }
  }

  /** Replaces the version that the person was told of. Should there be yet another one, it is told of as well. */
  keepMine(): void {
    if (!this.open) return;
    this.end();
    this.user.settled(this.tag, null);
  }

  private end(): void {
    if (this.notice !== null) removeNotice(this.store, this.notice);
    this.notice = null;
    setTourView(this.store, { conflict: false });
  }
}
