// What a page shows of a tour that plays: the camera, the stop, the things there, and what can be done now.
import type { Pose } from "../geo/camera.js";
import type { Stop, Thing } from "./types.js";

/**
 * `stop`: at a stop, in its pose. `moving`: on the way to one. `paused`: on the way, halted until play. `look`: the person looks elsewhere, at a stop or
 * on the way. `empty`: the tour has no stops.
 */
export type Phase = "empty" | "stop" | "moving" | "paused" | "look";

export interface BranchChoice {
  readonly label: string;
  readonly to: Stop;
}

export interface PlayerView {
  readonly phase: Phase;
  /** Null: the tour has no stops. */
  readonly pose: Pose | null;
  /** Where one is, or is going. */
  readonly stop: Stop | null;
  /** One is at this stop, though perhaps looking elsewhere. */
  readonly arrived: boolean;
  /** Those of the stop; on the way also those of the stop that was left, so that nothing vanishes before its eyes. */
  readonly things: readonly Thing[];
  readonly progress: {
    /** Place of the stop in the list, from 0. */
    readonly index: number;
    readonly count: number;
    /** Share of the way that is done; at a stop that autoplay will leave, of its pause. Else 1. */
    readonly share: number;
  };
  /** Autoplay goes on by itself. */
  readonly playing: boolean;
  /** At a stop that nothing follows. */
  readonly ended: boolean;
  /** Grows with every cut, so that a page can fade from one picture to the next. */
  readonly cuts: number;
  readonly can: {
    readonly next: boolean;
    readonly previous: boolean;
    /** Starts autoplay or goes on with a halted way. */
    readonly play: boolean;
    readonly pause: boolean;
    /** Turns back to the stop's view, or goes on to the stop. */
    readonly back: boolean;
    /** In the order of the stop's branches. */
    readonly branches: readonly BranchChoice[];
  };
}

/** Shown at one of these stops, or always. */
export function thingsAt(things: readonly Thing[], stops: readonly (Stop | null)[]): readonly Thing[] {
  return things.filter((thing) => {
    const { stops: at } = thing;
    return at === null || stops.some((stop) => stop !== null && at.includes(stop.id));
  });
}
