// When exact frames are asked for: 120 ms after the camera came to rest, of one side after the other (a client has one view at a time, so with the
// swipe on the earlier project is asked for when the main one is complete), and no more when it moves.
import type { Clock } from "../base/clock.js";
import type { Which } from "../protocol/link_api.js";

export const REST_MS = 120;

export interface ViewRequestsOptions {
  readonly clock: Clock;
  /** Sends a view of this side at the present pose; returns its seq. */
  ask(side: Which): number;
  stop(): void;
  /** The sides that are shown now, in the order in which they are wanted. */
  sides(): readonly Which[];
  /** Exact frames are wanted and the engine can make them. */
  allowed(): boolean;
  /** The camera has rested long enough. */
  onRest(): void;
  /** Last pass that arrived, over all sides; -1: none yet. */
  onProgress(pass: number, passes: number): void;
}

interface Arrived {
  readonly seq: number;
  readonly pass: number;
  readonly passes: number;
  readonly project: Which;
}

const USUAL_PASSES = 3;

export class ViewRequests {
  private readonly options: ViewRequestsOptions;
  private cancelTimer: (() => void) | null = null;
  private current: { readonly side: Which; readonly seq: number; pass: number } | null = null;
  private complete = new Set<Which>();
  private rests = false;

  constructor(options: ViewRequestsOptions) {
    this.options = options;
  }

  get resting(): boolean {
    return this.rests;
  }

  /** The camera moved, or what was asked for is no longer what is wanted (another size, another scene): begins anew after a rest. */
  moved(): void {
    this.rests = false;
    this.giveUp();
    if (this.complete.size > 0) this.complete = new Set();
    this.options.onProgress(-1, USUAL_PASSES);
    this.cancelTimer?.();
    this.cancelTimer = this.options.clock.after(REST_MS, () => {
      this.cancelTimer = null;
      this.rests = true;
      this.options.onRest();
      this.next();
    });
  }

  /** Conditions changed: what is allowed, which sides are shown. */
  refresh(): void {
    if (!this.options.allowed() || (this.current !== null && !this.options.sides().includes(this.current.side))) {
      this.giveUp();
    }
    this.next();
  }

  /** Is this frame one that was asked for and newer than the last? Then it counts as shown. */
  accept(frame: Arrived): boolean {
    const current = this.current;
    if (current === null || frame.seq !== current.seq || frame.project !== current.side || frame.pass <= current.pass) {
      return false;
    }
    current.pass = frame.pass;
    const sides = this.options.sides();
    const before = Math.max(0, sides.indexOf(current.side));
    this.options.onProgress(before * frame.passes + frame.pass, Math.max(1, sides.length) * frame.passes);
    if (frame.pass >= frame.passes - 1) {
      this.complete.add(current.side);
      this.current = null;
      this.next();
    }
    return true;
  }

  dispose(): void {
    this.cancelTimer?.();
    this.cancelTimer = null;
    this.rests = false;
    this.giveUp();
  }

  private giveUp(): void {
    if (this.current === null) return;
    this.current = null;
    this.options.stop();
  }

  private next(): void {
    if (!this.rests || this.current !== null || !this.options.allowed()) return;
    const side = this.options.sides().find((candidate) => !this.complete.has(candidate));
    if (side === undefined) return;
    this.current = { side, seq: this.options.ask(side), pass: -1 };
  }
}
