// Opacity over time: in and out in 150 ms, or at once where motion is reduced. Time is an argument.
export const FADE_MS = 150;

export class Fade {
  private value = 0;
  private target = 0;
  private lastMs: number | null = null;

  get opacity(): number {
    return this.value;
  }

  get active(): boolean {
    return this.value !== this.target;
  }

  get gone(): boolean {
    return this.value === 0 && this.target === 0;
  }

  to(target: 0 | 1, atOnce: boolean): void {
    this.target = target;
    if (atOnce) this.value = target;
    if (this.value === target) this.lastMs = null;
  }

  /** Goes on; the first step of a change only notes the time. */
  step(nowMs: number): void {
    if (!this.active) {
      this.lastMs = null;
      return;
    }
    const passed = this.lastMs === null ? 0 : Math.max(0, nowMs - this.lastMs) / FADE_MS;
    this.lastMs = nowMs;
    this.value =
      this.target > this.value
        ? Math.min(this.target, this.value + passed)
        : Math.max(this.target, this.value - passed);
    if (!this.active) this.lastMs = null;
  }
}
