// Keeps the documents in the project's files: loads them at the start, saves what has changed a second after the last change. A file that could
// not be read is never overwritten. What another window has saved meanwhile is joined with what was made here, but for the tour: there a person decides.
// Documents that this session may not save stay in the page.
import { errorText } from "../base/abort.js";
import type { Clock } from "../base/clock.js";
import { Disposer } from "../base/disposer.js";
import { hashHex } from "../base/hash.js";
import { ChangedElsewhere, type LoadedDocument, type SaveOptions } from "../protocol/documents_client.js";
import type { Documents } from "../state/app_state.js";
import type { MeasuredProject } from "../state/measurements_file.js";
import { addNotice } from "../state/notices.js";
import {
  DOCUMENT_FILES,
  type DocumentFile,
  documentPart,
  documentRemark,
  readDocument,
  withDocumentPart,
  writeDocument,
} from "../state/persistence.js";
import type { Store } from "../state/store.js";
import { setTourView } from "../state/tour_changes.js";
import { readSavedTour } from "../state/tour_document.js";
import { readTour } from "../tour/read.js";
import { writeTour } from "../tour/write.js";
import { joinDocuments } from "./join_documents.js";
import { TourConflict } from "./tour_conflict.js";

export interface DocumentFiles {
  load(file: DocumentFile): Promise<LoadedDocument>;
  /** Returns the tag of what is saved now. Rejects with ChangedElsewhere when the file is not the one of `ifMatch`. */
  save(file: DocumentFile, text: string, options: SaveOptions): Promise<string | null>;
}

export interface KeeperOptions {
  readonly project: MeasuredProject;
  readonly store: Store;
  readonly clock: Clock;
  readonly files: DocumentFiles;
}

const SAVE_AFTER_MS = 1000;
const TRY_AGAIN_MS = 10_000;
/** Saving, joining and saving again, while other windows save as well. */
const TRIES = 3;
const MOST_SENT = 4;
const TOUR: DocumentFile = "tour.json";

interface Sent {
  readonly text: string;
  readonly documents: Documents;
  /** In a way that outlives the page. */
  readonly flushed: boolean;
}

/** The server writes a tour with other spaces than were sent. */
function isSameTour(file: DocumentFile, a: string, b: string): boolean {
  if (file !== TOUR) return false;
  try {
    return writeTour(readTour(JSON.parse(a))) === writeTour(readTour(JSON.parse(b)));
  } catch {
    return false;
  }
}

export class DocumentsKeeper {
  private readonly options: KeeperOptions;
  private readonly disposer = new Disposer();
  /** Documents whose part is in each file. */
  private readonly saved = new Map<DocumentFile, Documents>();
  /** The content of each file that is known here. */
  private readonly tags = new Map<DocumentFile, string | null>();
  /** What was sent without hearing whether it was saved. */
  private readonly sent = new Map<DocumentFile, readonly Sent[]>();
  /** Files that could not be read. */
  private readonly blocked = new Set<DocumentFile>();
  readonly conflict: TourConflict;
  private loaded = false;
  private saving = false;
  private cancelTimer: (() => void) | null = null;
  private lastFailure = "";

  constructor(options: KeeperOptions) {
    this.options = options;
    const { store } = options;
    this.remember(store.get().documents);
    this.conflict = new TourConflict(store, {
      load: () => options.files.load(TOUR),
      settled: (tag, documents) => {
        this.tags.set(TOUR, tag);
        if (documents !== null) this.saved.set(TOUR, documents);
        this.saveAfter(0);
      },
    });
    this.disposer.add(
      store.subscribe(
        (state) => state.documents,
        () => this.changed(),
      ),
    );
  }

  /** Resolves when the files have been read, or could not be. */
  async load(): Promise<void> {
    const { store, project } = this.options;
    const before = store.get().documents;
    const answers = await Promise.allSettled(DOCUMENT_FILES.map((file) => this.options.files.load(file)));
    if (this.disposer.disposed) return;
    let documents = before;
    answers.forEach((answer, i) => {
      const file = DOCUMENT_FILES[i];
      if (file === undefined) return;
      try {
        if (answer.status === "rejected") throw answer.reason;
        const { text, tag } = answer.value;
        if (file === TOUR) documents = this.loadTour(documents, text);
        else if (text !== null) documents = readDocument(documents, file, text, project);
        this.tags.set(file, tag);
        const remark = text === null ? "" : documentRemark(file, text);
        if (remark !== "") addNotice(store, "info", remark);
      } catch (error) {
        this.blocked.add(file);
        const failure = `${file} was not loaded: ${errorText(error)}. It will not be overwritten: correct it or move it away, then reload the page.`;
        if (file === TOUR) setTourView(store, { locked: failure });
        addNotice(store, "error", failure);
      }
    });
    this.remember(documents);
    // What was made while the files were on their way comes behind what they hold.
    const now = store.get().documents;
    store.loadDocuments(now === before ? documents : joinDocuments(documents, before, now));
    this.loaded = true;
    if (this.unsavedFiles().length > 0) this.changed();
  }

  /** Something is not in its file yet. */
  get unsaved(): boolean {
    return this.saving || this.unsavedFiles().length > 0;
  }

  private loadTour(documents: Documents, text: string | null): Documents {
    const { store } = this.options;
    const { tour, locked, missing, unsafe } = readSavedTour(text, store.get().rights);
    setTourView(store, { locked, missing });
    if (unsafe) {
      this.blocked.add(TOUR);
      addNotice(store, "error", locked ?? "");
    }
    return { ...documents, tour };
  }

  /** Saves now what is not saved, without waiting for the answer: the page may be gone the next moment. */
  flush(): void {
    for (const file of this.savableFiles()) {
      const newest = this.sent.get(file)?.at(-1);
      // Sent already, and nothing has changed since.
      if (newest?.flushed === true && this.hasPartOf(file, newest.documents)) continue;
      // Nobody is left to read what is wrong.
      this.send(file, this.mayBe(file), true).catch(() => {});
    }
  }

  /** Tags of what the file may be now without another window having changed it: as it was known, or as what was sent has made it. */
  private mayBe(file: DocumentFile): string | null {
    const tag = this.tags.get(file) ?? null;
    if (tag === null) return null;
    const hashes = (this.sent.get(file) ?? []).map(({ text }) => `"${hashHex(new TextEncoder().encode(text))}"`);
    return [tag, ...hashes].join(", ");
  }

  private hasPartOf(file: DocumentFile, documents: Documents): boolean {
    return documentPart(documents, file) === documentPart(this.options.store.get().documents, file);
  }

  dispose(): void {
    this.cancelTimer?.();
    this.cancelTimer = null;
    this.disposer.dispose();
  }

  private remember(documents: Documents): void {
    for (const file of DOCUMENT_FILES) this.saved.set(file, documents);
  }

  private unsavedFiles(): DocumentFile[] {
    const { documents } = this.options.store.get();
    return DOCUMENT_FILES.filter((file) => this.maySave(file) && !this.isSaved(file, documents));
  }

  private maySave(file: DocumentFile): boolean {
    const { rights } = this.options.store.get();
    return file === TOUR ? rights.tour : rights.documents;
  }

  private isSaved(file: DocumentFile, documents: Documents): boolean {
    const saved = this.saved.get(file);
    return saved !== undefined && documentPart(saved, file) === documentPart(documents, file);
  }

  private savableFiles(): DocumentFile[] {
    if (!this.loaded) return [];
    return this.unsavedFiles().filter((file) => !this.blocked.has(file) && !(file === TOUR && this.conflict.open));
  }

  private changed(): void {
    if (this.loaded && !this.saving) this.saveAfter(SAVE_AFTER_MS);
  }

  private saveAfter(delayMs: number): void {
    this.cancelTimer?.();
    this.cancelTimer = this.options.clock.after(delayMs, () => {
      this.cancelTimer = null;
      void this.save();
    });
  }

  private async save(): Promise<void> {
    if (this.saving) return;
    const { store } = this.options;
    const wanted = this.savableFiles();
    let failure = "";
    if (wanted.length > 0) {
      this.saving = true;
      store.set({ save: "saving" });
    }
    for (const file of wanted) {
      try {
        await this.saveFile(file);
      } catch (error) {
        const next = this.blocked.has(file)
          ? "Correct it or move it away, then reload the page"
          : "It is tried again every 10 seconds";
        failure = `${file} could not be saved: ${errorText(error)}. ${next}.`;
      }
    }
    this.saving = false;
    if (this.disposer.disposed) return;
    if (failure === "" && this.unsavedFiles().some((file) => this.blocked.has(file))) {
      failure = "These changes are not saved, because the file could not be read.";
    }
    if (failure !== "") this.failed(failure);
    else this.done();
  }

  private async saveFile(file: DocumentFile): Promise<void> {
    for (let attempt = 1; !this.disposer.disposed; attempt += 1) {
      try {
        await this.send(file, this.tags.get(file) ?? null, false);
        return;
      } catch (error) {
        if (!(error instanceof ChangedElsewhere) || attempt >= TRIES) throw error;
      }
      await (file === TOUR ? this.compareTour() : this.joinWithFile(file));
      if (file === TOUR && this.conflict.open) return;
      if (this.isSaved(file, this.options.store.get().documents)) return;
    }
  }

  private async send(file: DocumentFile, ifMatch: string | null, keepalive: boolean): Promise<void> {
    const { store, project, files } = this.options;
    const { documents } = store.get();
    const text = writeDocument(documents, file, project);
    const own: Sent = { text, documents, flushed: keepalive };
    this.sent.set(file, [...(this.sent.get(file) ?? []), own].slice(-MOST_SENT));
    try {
      const tag = await files.save(file, text, { ifMatch, keepalive });
      const sent = this.sent.get(file) ?? [];
      const place = sent.indexOf(own);
      // Something newer has been saved, and was answered first.
      if (place < 0) return;
      this.tags.set(file, tag);
      this.saved.set(file, documents);
      this.sent.set(file, sent.slice(place + 1));
    } catch (error) {
      if (error instanceof ChangedElsewhere) {
        const others = (this.sent.get(file) ?? []).filter((one) => one !== own);
        this.sent.set(file, others);
      }
      throw error;
    }
  }

  /** The file is another one than was known here: from now on both have what it holds. */
  private async joinWithFile(file: DocumentFile): Promise<void> {
    const { store, project, files } = this.options;
    const { text, tag } = await files.load(file);
    if (this.disposer.disposed || this.isOwn(file, { text, tag }) || text === null) return;
    const made = store.get().documents;
    let loaded: Documents;
    try {
      loaded = readDocument(made, file, text, project);
    } catch (error) {
      this.blocked.add(file);
      throw new Error(`it was changed outside this page and cannot be read now: ${errorText(error)}`);
    }
    const before = withDocumentPart(made, file, this.saved.get(file) ?? made);
    this.saved.set(file, loaded);
    this.tags.set(file, tag);
    store.loadDocuments(joinDocuments(loaded, before, made));
    addNotice(store, "info", `${file} was changed in another window: both are kept.`);
  }

  /** The tour's file is another one: whoever looks at this page decides. */
  private async compareTour(): Promise<void> {
    const found = await this.options.files.load(TOUR);
    if (!this.disposer.disposed && !this.isOwn(TOUR, found)) this.conflict.begin(found.tag);
  }

  /** Nobody else has written what the file is now; then that is known from now on. */
  private isOwn(file: DocumentFile, { text, tag }: LoadedDocument): boolean {
    // Saved here while this was asked.
    if (tag !== null && tag === this.tags.get(file)) return true;
    const own = this.sent
      .get(file)
      ?.find((one) => one.text === text || (text !== null && isSameTour(file, one.text, text)));
    if (text !== null && own === undefined) return false;
    // Taken away by somebody, or saved by this page, which did not hear of it.
    if (own !== undefined) this.saved.set(file, own.documents);
    this.tags.set(file, tag);
    return true;
  }

  private failed(failure: string): void {
    const { store } = this.options;
    store.set({ save: "failed" });
    // One that was closed by the user does not come back every 10 seconds.
    if (failure !== this.lastFailure) addNotice(store, "error", failure);
    this.lastFailure = failure;
    if (this.savableFiles().length > 0) this.saveAfter(TRY_AGAIN_MS);
  }

  private done(): void {
    const { store } = this.options;
    this.lastFailure = "";
    if (this.savableFiles().length > 0) {
      store.set({ save: "unsaved" });
      this.saveAfter(SAVE_AFTER_MS);
    } else if (this.conflict.open && this.unsavedFiles().includes(TOUR)) {
      store.set({ save: "failed" });
    } else {
      store.set({ save: "saved" });
    }
  }
}
