// Frames per second while the camera moves, and what is given up for them on a slow machine: first pixels of dense screens, then shape, then detail.

export interface Quality {
  /** Most device pixels per CSS pixel. */
  readonly pixelRatio: number;
  /** Error of tiles in pixels. */
  readonly errorTarget: number;
  /** Meshes with fewer triangles than pixels could show. */
  readonly coarse: boolean;
}

const FULL_ERROR_PX = 16;
const LEVELS: readonly Quality[] = [
  { pixelRatio: 2, errorTarget: FULL_ERROR_PX, coarse: false },
  { pixelRatio: 1, errorTarget: FULL_ERROR_PX, coarse: true },
  { pixelRatio: 1, errorTarget: 32, coarse: true },
  { pixelRatio: 0.75, errorTarget: 48, coarse: true },
];
const TOO_SLOW_MS = 36;
const FAST_MS = 19;
const FRAMES_TO_LOWER = 8;
const FRAMES_TO_RAISE = 90;
/** A longer gap is no slow frame but a pause: the window was hidden, say. */
const LONGEST_MS = 500;
const NO_RAISE_MS = 20_000;

export class FrameMeter {
  private times: number[] = [];
  private level: number;
  private readonly best: number;
  private slow: number[] = [];
  private fast = 0;
  private noRaiseUntilMs = 0;
  private lastFps = 0;

  /** `slow`: the processor draws, so the first compromise is made from the start. */
  constructor(slow = false) {
    this.best = slow ? 1 : 0;
    this.level = this.best;
  }

  /** Of the last second in which something moved. */
  get fps(): number {
    return this.lastFps;
  }

  /** At rest everything is drawn as well as it can be. */
  quality(moving: boolean): Quality {
    return (moving ? LEVELS[this.level] : LEVELS[0]) ?? { pixelRatio: 1, errorTarget: FULL_ERROR_PX, coarse: false };
  }

  /** A frame was drawn. `moving`: the camera is on its way, so the time since the last frame says how fast we are. */
  frame(nowMs: number, moving: boolean): void {
    if (!moving) {
      this.times = [];
      this.slow = [];
      return;
    }
    const last = this.times[this.times.length - 1];
    if (last !== undefined && nowMs - last > LONGEST_MS) this.times = [];
    else if (last !== undefined) this.judge(nowMs, nowMs - last);
    this.times.push(nowMs);
    while (nowMs - (this.times[0] ?? nowMs) > 1000) this.times.shift();
    const first = this.times[0] ?? nowMs;
    if (this.times.length > 4 && nowMs > first) this.lastFps = (1000 * (this.times.length - 1)) / (nowMs - first);
  }

  private judge(nowMs: number, gapMs: number): void {
    this.slow = [...this.slow, gapMs].slice(-FRAMES_TO_LOWER);
    const mean = this.slow.reduce((sum, gap) => sum + gap, 0) / this.slow.length;
    this.fast = gapMs < FAST_MS ? this.fast + 1 : 0;
    if (this.slow.length === FRAMES_TO_LOWER && mean > TOO_SLOW_MS && this.level < LEVELS.length - 1) {
      this.level += 1;
      this.slow = [];
      this.noRaiseUntilMs = nowMs + NO_RAISE_MS;
    } else if (this.fast >= FRAMES_TO_RAISE && this.level > this.best && nowMs > this.noRaiseUntilMs) {
      this.level -= 1;
      this.fast = 0;
    }
  }
}
