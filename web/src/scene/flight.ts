// Smooth moves of the camera from pose to pose. Time is an argument.
import { interpolatePose } from "../geo/camera.js";
import type { CameraPose } from "../state/app_state.js";

export interface Leg {
  readonly to: CameraPose;
  readonly durationMs: number;
}

function easeInOut(u: number): number {
  return u < 0.5 ? 4 * u * u * u : 1 - (-2 * u + 2) ** 3 / 2;
}

export class Flight {
  private legs: Leg[] = [];
  private from: CameraPose | null = null;
  private beganMs: number | null = null;
  private done: (() => void) | null = null;

  get active(): boolean {
    return this.legs.length > 0;
  }

  /** Where it leads; null: nowhere. */
  get target(): CameraPose | null {
    return this.legs[this.legs.length - 1]?.to ?? null;
  }

  /** Replaces a flight under way, which then counts as over. */
  start(from: CameraPose, legs: readonly Leg[]): Promise<void> {
    this.cancel();
    this.from = from;
    this.legs = [...legs];
    this.beganMs = null;
    return new Promise((resolve) => {
      this.done = resolve;
    });
  }

  cancel(): void {
    this.legs = [];
    this.from = null;
    const done = this.done;
    this.done = null;
    done?.();
  }

  /** The pose at this time; null: there is no flight. The first call after start() is its beginning. */
  step(nowMs: number): CameraPose | null {
    let leg = this.legs[0];
    if (leg === undefined || this.from === null) return null;
    this.beganMs ??= nowMs;
    while (nowMs - this.beganMs >= leg.durationMs) {
      this.beganMs += leg.durationMs;
      this.from = leg.to;
      this.legs.shift();
      const next = this.legs[0];
      if (next === undefined) {
        this.cancel();
        return leg.to;
      }
      leg = next;
    }
    return interpolatePose(this.from, leg.to, easeInOut((nowMs - this.beganMs) / leg.durationMs));
  }
}
