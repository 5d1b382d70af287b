// What the panels say about the view: heading, scale and speed, at most 10 times a second.
import type { Clock } from "../base/clock.js";
import type { Readout } from "../state/app_state.js";
import type { Store } from "../state/store.js";

const INTERVAL_MS = 100;

export type ViewReadout = Omit<Readout, "cursor">;

/** Headings between 0 and 360 and a little noise must not wake the panels. */
function rounded(readout: ViewReadout): ViewReadout {
  const to = (value: number, decimals: number) => (Number.isFinite(value) ? Number(value.toFixed(decimals)) : 0);
  return {
    metresPerPx: readout.metresPerPx === null ? null : Number(readout.metresPerPx.toPrecision(4)),
    headingDeg: to(readout.headingDeg, 2),
    pitchDeg: to(readout.pitchDeg, 2),
    fps: to(readout.fps, 1),
  };
}

export class ReadoutWriter {
  private readonly store: Store;
  private readonly clock: Clock;
  private readonly measure: () => ViewReadout;
  private lastMs = Number.NEGATIVE_INFINITY;
  private cancel: (() => void) | null = null;

  constructor(store: Store, clock: Clock, measure: () => ViewReadout) {
    this.store = store;
    this.clock = clock;
    this.measure = measure;
  }

  /** The view changed: written now, or when the last time is long enough ago. */
  changed(): void {
    if (this.cancel !== null) return;
    const wait = this.lastMs + INTERVAL_MS - this.clock.nowMs();
    this.cancel = this.clock.after(Math.max(0, wait), () => {
      this.cancel = null;
      this.write();
    });
  }

  dispose(): void {
    this.cancel?.();
    this.cancel = null;
  }

  private write(): void {
    this.lastMs = this.clock.nowMs();
    const next = rounded(this.measure());
    const { readout } = this.store.get();
    const same =
      readout.metresPerPx === next.metresPerPx &&
      readout.headingDeg === next.headingDeg &&
      readout.pitchDeg === next.pitchDeg &&
      readout.fps === next.fps;
    if (!same) this.store.set({ readout: { ...readout, ...next } });
  }
}
