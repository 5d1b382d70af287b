// Draws on demand: one animation frame after something changed, and one after the other only while something moves.
export class RenderLoop {
  /** Draws; returns true while something moves by itself. */
  private readonly draw: (nowMs: number) => boolean;
  private handle: number | null = null;
  private paused = false;
  private ended = false;
  private count = 0;

  constructor(draw: (nowMs: number) => boolean) {
    this.draw = draw;
  }

  /** Frames drawn so far. */
  get drawn(): number {
    return this.count;
  }

  /** A frame will come. */
  get pending(): boolean {
    return this.handle !== null;
  }

  invalidate(): void {
    if (this.handle !== null || this.paused || this.ended) return;
    this.handle = requestAnimationFrame(this.run);
  }

  /** Nothing can be drawn (the graphics card was reset), or again. */
  pause(paused: boolean): void {
    this.paused = paused;
    if (paused && this.handle !== null) {
      cancelAnimationFrame(this.handle);
      this.handle = null;
    }
    this.invalidate();
  }

  /** Draws at once, outside the animation frames. */
  drawNow(): void {
    if (this.paused || this.ended) return;
    const again = this.draw(performance.now());
    this.count += 1;
    if (again) this.invalidate();
  }

  dispose(): void {
    this.ended = true;
    if (this.handle !== null) cancelAnimationFrame(this.handle);
    this.handle = null;
  }

  private readonly run = (nowMs: number): void => {
    this.handle = null;
    const again = this.draw(nowMs);
    this.count += 1;
    if (again) this.invalidate();
  };
}
