// Models by their URL: each file is loaded once, a few at a time and within a limit of memory. Those that nothing shows any more are kept for a while, as
// the next stop of a tour may show them again, and freed when there are too many or their memory is needed.
import type { LoadBytes } from "./load_bytes.js";
import type { Model, ReadModel } from "./model.js";

const MOST_BYTES = 256 * 2 ** 20;
const KEPT_BYTES = 96 * 2 ** 20;
const MOST_LOADS = 2;

export interface ModelStoreOptions {
  readonly loadBytes: LoadBytes;
  readonly read: ReadModel;
  /** Of geometry and textures of all models. */
  readonly mostBytes?: number;
  /** Of those that nothing shows. */
  readonly keptBytes?: number;
  readonly mostLoads?: number;
}

type Outcome = Model | Error;

interface Entry {
  readonly url: string;
  readonly abort: AbortController;
  readonly users: Set<(outcome: Outcome) => void>;
  state: "waiting" | "loading" | "done";
  outcome: Outcome | null;
  bytes: number;
}

export class ModelStore {
  private readonly options: Required<ModelStoreOptions>;
  private readonly entries = new Map<string, Entry>();
  private loads = 0;
  private usedBytes = 0;

  constructor(options: ModelStoreOptions) {
    this.options = { mostBytes: MOST_BYTES, keptBytes: KEPT_BYTES, mostLoads: MOST_LOADS, ...options };
  }

  /** Something is on its way. */
  get busy(): boolean {
    for (const { state } of this.entries.values()) if (state !== "done") return true;
    return false;
  }

  /** What the models that are held take. */
  get bytes(): number {
    return this.usedBytes;
  }

  /** Calls `done` once, later or never; returns the function that gives the model back, or ends the loading. */
  acquire(url: string, done: (outcome: Outcome) => void): () => void {
    const entry = this.entries.get(url) ?? this.add(url);
    // Two users may give the same function.
    const own = (outcome: Outcome) => done(outcome);
    entry.users.add(own);
    const { outcome } = entry;
    if (outcome !== null) {
      queueMicrotask(() => {
        if (entry.users.has(own)) own(outcome);
      });
    }
    this.next();
    return () => {
      if (!entry.users.delete(own) || entry.users.size > 0) return;
      if (entry.outcome === null || entry.outcome instanceof Error) {
        this.drop(entry);
        return;
      }
      // The newest are last.
      this.entries.delete(url);
      this.entries.set(url, entry);
      this.freeUnused(this.options.keptBytes);
    };
  }

  dispose(): void {
    for (const entry of [...this.entries.values()]) {
      entry.users.clear();
      this.drop(entry);
    }
  }

  private add(url: string): Entry {
    const entry: Entry = {
      url,
      abort: new AbortController(),
      users: new Set(),
      state: "waiting",
      outcome: null,
      bytes: 0,
    };
    this.entries.set(url, entry);
    return entry;
  }

  private next(): void {
    for (const entry of this.entries.values()) {
      if (this.loads >= this.options.mostLoads) return;
      if (entry.state === "waiting") void this.load(entry);
    }
  }

  private async load(entry: Entry): Promise<void> {
    entry.state = "loading";
    this.loads += 1;
    let outcome: Outcome;
    try {
      outcome = await this.make(entry);
    } catch (error) {
      outcome = error instanceof Error ? error : new Error(String(error));
      this.giveBack(entry);
    }
    this.loads -= 1;
    entry.state = "done";
    if (this.wanted(entry)) {
      entry.outcome = outcome;
      for (const user of [...entry.users]) if (entry.users.has(user)) user(outcome);
    } else {
      if (!(outcome instanceof Error)) outcome.dispose();
      this.giveBack(entry);
    }
    this.next();
  }

  private async make(entry: Entry): Promise<Model> {
    const { loadBytes, read, mostBytes } = this.options;
    const bytes = await loadBytes(entry.url, entry.abort.signal);
    if (!this.wanted(entry)) throw new Error("it is no longer wanted");
    const planned = read(bytes);
    if (this.usedBytes + planned.bytes > mostBytes) this.freeUnused(0);
    if (this.usedBytes + planned.bytes > mostBytes) {
      const mebibytes = (count: number) => Math.ceil(count / 2 ** 20);
      throw new Error(
        `it needs ${mebibytes(planned.bytes)} MiB of memory, and all models together may take ${mebibytes(mostBytes)} MiB`,
      );
    }
    entry.bytes = planned.bytes;
    this.usedBytes += planned.bytes;
    return planned.make();
  }

  /** Frees the oldest of those that nothing shows until they take no more than this. */
  private freeUnused(leftBytes: number): void {
    const unused = [...this.entries.values()].filter(({ users, state }) => state === "done" && users.size === 0);
    let bytes = unused.reduce((sum, entry) => sum + entry.bytes, 0);
    for (const entry of unused) {
      if (bytes <= leftBytes) return;
      bytes -= entry.bytes;
      this.drop(entry);
    }
  }

  private wanted(entry: Entry): boolean {
    return this.entries.get(entry.url) === entry;
  }

  private drop(entry: Entry): void {
    this.entries.delete(entry.url);
    entry.abort.abort();
    // What is still loading frees itself when it ends.
    if (entry.state !== "done") return;
    if (entry.outcome !== null && !(entry.outcome instanceof Error)) entry.outcome.dispose();
    entry.outcome = null;
    this.giveBack(entry);
  }

  private giveBack(entry: Entry): void {
    this.usedBytes -= entry.bytes;
    entry.bytes = 0;
  }
}
