// Keeps the documents in the project's files: loads them at the start, saves what has changed a second after the last change. A file that could
// not be read is never overwritten.
import { errorText } from "../base/abort.js";
import type { Clock } from "../base/clock.js";
import { Disposer } from "../base/disposer.js";
import type { Documents } from "../state/app_state.js";
import type { MeasuredProject } from "../state/measurements_file.js";
import { addNotice } from "../state/notices.js";
import { DOCUMENT_FILES, type DocumentFile, documentPart, readDocument, writeDocument } from "../state/persistence.js";
import type { Store } from "../state/store.js";
import { joinDocuments } from "./join_documents.js";

export interface DocumentFiles {
  /** Null: there is none yet. */
  load(file: DocumentFile): Promise<string | null>;
  save(file: DocumentFile, text: string, keepalive?: boolean): Promise<void>;
}

export interface KeeperOptions {
  readonly project: MeasuredProject;
  readonly store: Store;
  readonly clock: Clock;
  readonly files: DocumentFiles;
}

const SAVE_AFTER_MS = 1000;
const TRY_AGAIN_MS = 10_000;

export class DocumentsKeeper {
  private readonly options: KeeperOptions;
  private readonly disposer = new Disposer();
  /** The part of the documents that is in each file. */
  private readonly saved = new Map<DocumentFile, object>();
  /** Files that could not be read. */
  private readonly blocked = new Set<DocumentFile>();
  private loaded = false;
  private saving = false;
  private cancelTimer: (() => void) | null = null;
  private lastFailure = "";

  constructor(options: KeeperOptions) {
    this.options = options;
    const { store } = options;
    this.remember(store.get().documents);
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
    const texts = await Promise.allSettled(DOCUMENT_FILES.map((file) => this.options.files.load(file)));
    if (this.disposer.disposed) return;
    let documents = before;
    texts.forEach((text, i) => {
      const file = DOCUMENT_FILES[i];
      if (file === undefined) return;
      try {
        if (text.status === "rejected") throw text.reason;
        if (text.value !== null) documents = readDocument(documents, file, text.value, project);
      } catch (error) {
        this.blocked.add(file);
        addNotice(
          store,
          "error",
          `${file} was not loaded: ${errorText(error)}. It will not be overwritten: correct it or move it away, then reload the page.`,
        );
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

  /** Saves now what is not saved, without waiting for the answer: the page may be gone the next moment. */
  flush(): void {
    for (const file of this.savableFiles()) {
      const { store, project, files } = this.options;
      try {
        files.save(file, writeDocument(store.get().documents, file, project), true).catch(() => {});
      } catch {
        // Nobody is left to read what is wrong.
      }
    }
  }

  /** Saves as soon as possible. */
  hurry(): void {
    if (this.savableFiles().length > 0) this.saveAfter(0);
  }

  dispose(): void {
    this.cancelTimer?.();
    this.cancelTimer = null;
    this.disposer.dispose();
  }

  private remember(documents: Documents): void {
    for (const file of DOCUMENT_FILES) this.saved.set(file, documentPart(documents, file));
  }

  private unsavedFiles(): DocumentFile[] {
    const { documents } = this.options.store.get();
    return DOCUMENT_FILES.filter((file) => this.saved.get(file) !== documentPart(documents, file));
  }

  private savableFiles(): DocumentFile[] {
    return this.loaded ? this.unsavedFiles().filter((file) => !this.blocked.has(file)) : [];
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
    const { store, project, files } = this.options;
    const wanted = this.savableFiles();
    let failure = "";
    if (wanted.length > 0) {
      this.saving = true;
      store.set({ save: "saving" });
    }
    for (const file of wanted) {
      const { documents } = store.get();
      try {
        await files.save(file, writeDocument(documents, file, project));
        this.saved.set(file, documentPart(documents, file));
      } catch (error) {
        failure = `${file} could not be saved: ${errorText(error)}. It is tried again every 10 seconds.`;
      }
    }
    this.saving = false;
    if (this.disposer.disposed) return;
    if (failure === "" && this.unsavedFiles().some((file) => this.blocked.has(file))) {
      failure = "These changes are not saved, because the file could not be read when the page was opened.";
    }
    if (failure !== "") this.failed(failure);
    else this.done();
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
    } else {
      store.set({ save: "saved" });
    }
  }
}
