// Requests that wait for their answer: ids, time limits, progress, and picks of which only the newest waits.
import { AbortError } from "../base/abort.js";
import type { Clock } from "../base/clock.js";

/** (id, what it is, 0..1 or null: unknown, it has ended). */
export type ProgressListener = (id: number, what: string, fraction: number | null, done: boolean) => void;

interface Pending {
  readonly what: string;
  /** Type of the server's text that answers it. */
  readonly answer: string;
  readonly timeoutMs: number;
  readonly shown: boolean;
  settle(value: unknown): void;
  fail(error: Error): void;
  stopTimer(): void;
}

export interface RequestOptions<T> {
  /** For the progress display: "Volume". */
  readonly what: string;
  readonly answer: string;
  /** Without an answer or progress for this long it is given up. */
  readonly timeoutMs: number;
  /** Told to the progress listener. */
  readonly shown: boolean;
  /** The text to send. Throws RangeError when the values are not possible. */
  readonly text: (id: number) => string;
  /** Narrows the value, which readServerText has checked. */
  readonly narrow: (value: unknown) => T;
}

export class Requests {
  private readonly clock: Clock;
  private readonly send: (text: string) => boolean;
  private readonly cancelText: (id: number) => string;
  private readonly progress: ProgressListener;
  private readonly pending = new Map<number, Pending>();
  private lastId = 0;

  /** `send` says whether the text went out (there is a connection). */
  constructor(
    clock: Clock,
    send: (text: string) => boolean,
    cancelText: (id: number) => string,
    progress: ProgressListener,
  ) {
    this.clock = clock;
    this.send = send;
    this.cancelText = cancelText;
    this.progress = progress;
  }

  start<T>(options: RequestOptions<T>, notConnected: string): Promise<T> {
    return new Promise<T>((resolve, reject) => {
      const id = this.lastId + 1;
      const text = options.text(id);
      if (!this.send(text)) throw new Error(notConnected);
      this.lastId = id;
      this.pending.set(id, {
        what: options.what,
        answer: options.answer,
        timeoutMs: options.timeoutMs,
        shown: options.shown,
        settle: (value) => resolve(options.narrow(value)),
        fail: reject,
        stopTimer: this.timer(id, options.timeoutMs),
      });
      if (options.shown) this.progress(id, options.what, null, false);
    });
  }

  private timer(id: number, timeoutMs: number): () => void {
    return this.clock.after(timeoutMs, () => {
      const seconds = Math.round(timeoutMs / 1000);
      this.send(this.cancelText(id));
      this.fail(
        id,
        new Error(`the engine did not answer within ${seconds} s; it may be busy with other windows: try again`),
      );
    });
  }

  private end(id: number): Pending | null {
    const entry = this.pending.get(id);
    if (entry === undefined) return null;
    this.pending.delete(id);
    entry.stopTimer();
    if (entry.shown) this.progress(id, entry.what, null, true);
    return entry;
  }

  /** An answer came. False: nobody waits for it (it was cancelled), or it is of another kind. */
  answer(id: number, type: string, value: unknown): boolean {
    const entry = this.pending.get(id);
    if (entry === undefined) return id <= this.lastId;
    if (entry.answer !== type) return false;
    this.end(id)?.settle(value);
    return true;
  }

  fail(id: number, error: Error): void {
    this.end(id)?.fail(error);
  }

  failAll(error: Error): void {
    for (const id of [...this.pending.keys()]) this.fail(id, error);
  }

  onProgress(id: number, fraction: number): void {
    const entry = this.pending.get(id);
    if (entry === undefined) return;
    entry.stopTimer();
    entry.stopTimer = this.timer(id, entry.timeoutMs);
    if (entry.shown) this.progress(id, entry.what, fraction, false);
  }

  /** The caller gives up; the engine is told. */
  cancel(id: number): void {
    if (!this.pending.has(id)) return;
    this.send(this.cancelText(id));
    this.fail(id, new AbortError());
  }

  get waiting(): number {
    return this.pending.size;
  }
}

/** Runs at most `most` tasks at a time; of those that wait, only the newest. The others reject with an AbortError. */
export class NewestWins<T> {
  private readonly most: number;
  private running = 0;
  private waiting: { readonly run: () => void; readonly drop: () => void } | null = null;

  constructor(most: number) {
    this.most = most;
  }

  start(task: () => Promise<T>): Promise<T> {
    return new Promise<T>((resolve, reject) => {
      const run = () => {
        this.running += 1;
        task()
          .then(resolve, reject)
          .finally(() => this.ended());
      };
      if (this.running < this.most) {
        run();
        return;
      }
      this.waiting?.drop();
      this.waiting = { run, drop: () => reject(new AbortError("a newer one replaced it")) };
    });
  }

  private ended(): void {
    this.running -= 1;
    const next = this.waiting;
    this.waiting = null;
    next?.run();
  }
}
