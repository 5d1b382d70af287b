// Time as an argument, so that tests need not wait.

export interface Clock {
  /** Milliseconds that only grow. */
  nowMs(): number;
  /** Runs `task` once after `delayMs`. Returns the function that prevents it. */
  after(delayMs: number, task: () => void): () => void;
}

// The few globals that browsers and Node share; declared here, because this room compiles without the DOM library.
interface TimeGlobals {
  readonly performance: { now(): number };
  setTimeout(task: () => void, delayMs: number): unknown;
  clearTimeout(handle: unknown): void;
}
const globals = globalThis as unknown as TimeGlobals;

export const systemClock: Clock = {
  nowMs: () => globals.performance.now(),
  after: (delayMs, task) => {
    const handle = globals.setTimeout(task, delayMs);
    return () => globals.clearTimeout(handle);
  },
};

interface Timer {
  readonly atMs: number;
  readonly order: number;
  readonly task: () => void;
}

/** A clock that stands still until it is told to go on. */
export class ManualClock implements Clock {
  private now = 0;
  private made = 0;
  private timers: Timer[] = [];

  nowMs(): number {
    return this.now;
  }

  after(delayMs: number, task: () => void): () => void {
    const timer = { atMs: this.now + Math.max(0, delayMs), order: this.made++, task };
    this.timers.push(timer);
    return () => {
      this.timers = this.timers.filter((other) => other !== timer);
    };
  }

  /** Lets time pass; timers run in their order, also those that others set meanwhile. */
  advance(ms: number): void {
    const until = this.now + ms;
    for (;;) {
      const due = this.timers.filter((timer) => timer.atMs <= until);
      const next = due.sort((a, b) => a.atMs - b.atMs || a.order - b.order)[0];
      if (next === undefined) break;
      this.timers = this.timers.filter((timer) => timer !== next);
      this.now = next.atMs;
      next.task();
    }
    this.now = until;
  }

  /** Timers that still wait. */
  get waiting(): number {
    return this.timers.length;
  }
}
