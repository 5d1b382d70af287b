// Plays a tour. No timers: whoever calls says what time it is (seconds that only grow), and asks for the view once per frame. Each change begins at the
// time of the call that found it due, so a page that was hidden does not rush through what it missed.
import type { Pose } from "../geo/camera.js";
import type { Heights } from "./heights.js";
import { lookedAround } from "./look.js";
import { type BranchChoice, type PlayerView, thingsAt } from "./player_view.js";
import { planRoute, poseAt, poseOf, type Route } from "./route.js";
import { firstStop, followingStop, type Path, type Stop, stopOf, type Tour } from "./types.js";

export interface PlayerOptions {
  readonly tour: Tour;
  /** Asked whenever a way begins: heights may come later than the tour. Null: nothing is known to be in the way. */
  heights(): Heights | null;
  /** True: all ways are cuts. */
  reducedMotion(): boolean;
  /** Where to begin, instead of where the tour begins. */
  readonly at?: string;
}

const DIRECT: Path = { kind: "direct" };
/** Autoplay stays at least this long at a stop that it reached by a cut: stops without pauses would flicker. */
const LEAST_STAY_S = 1;

interface AtStop {
  readonly kind: "stop";
  readonly stop: Stop;
  readonly sinceS: number;
  readonly byCut: boolean;
}
interface OnTheWay {
  readonly from: Stop | null;
  readonly stop: Stop;
  readonly route: Route;
}
interface Moving extends OnTheWay {
  readonly kind: "moving";
  readonly beganS: number;
  /** The way back to where one stands already. */
  readonly returning: boolean;
}
interface Paused extends OnTheWay {
  readonly kind: "paused";
  readonly afterS: number;
  readonly wasPlaying: boolean;
  readonly returning: boolean;
}
interface Look {
  readonly kind: "look";
  readonly pose: Pose;
  /** At this stop, or on the way to it. */
  readonly stop: Stop;
  readonly arrived: boolean;
  readonly from: Stop | null;
}
type State = { readonly kind: "empty" } | AtStop | Moving | Paused | Look;

/** How one got from a stop to the one after it. */
interface Visit {
  readonly stop: Stop;
  readonly path: Path;
}

export class TourPlayer {
  private readonly options: PlayerOptions;
  private state: State;
  private history: Visit[] = [];
  private playing = false;
  private cuts = 0;

  constructor(options: PlayerOptions, nowS: number) {
    this.options = options;
    const first = stopOf(options.tour, options.at ?? null) ?? firstStop(options.tour);
    this.state = first === null ? { kind: "empty" } : { kind: "stop", stop: first, sinceS: nowS, byCut: true };
  }

  /** Lets time pass and says what to show. */
  view(nowS: number): PlayerView {
    this.advance(nowS);
    return this.describe(nowS);
  }

  // ---- going ----

  /** To the stop that follows; from a way that was broken off, on to its stop. */
  next(nowS: number): void {
    this.advance(nowS);
    const { state } = this;
    if (state.kind === "empty") return;
    const here = this.here();
    if (here === null && state.kind !== "moving") {
      this.goOn(nowS);
      return;
    }
    const to = followingStop(this.options.tour, state.stop);
    // Still on the way to a stop, one is not where its own way begins.
    if (to !== null) this.leaveFor(to, here?.next?.path ?? DIRECT, nowS);
  }

  /** Back to the stop before, the way one came. */
  previous(nowS: number): void {
    this.advance(nowS);
    const visit = this.history.at(-1);
    if (visit === undefined || this.state.kind === "empty") return;
    this.history.pop();
    this.move(visit.stop, this.here() === null ? DIRECT : visit.path, nowS);
  }

  /** By the stop's branch of this number. */
  branch(index: number, nowS: number): void {
    this.advance(nowS);
    const choice = this.choices()[index];
    if (choice !== undefined) this.leaveFor(choice.to, choice.path, nowS);
  }

  /** To any stop: a hot spot, the map, the list. An id that is not there changes nothing. */
  goTo(id: string, nowS: number): void {
    this.advance(nowS);
    const to = stopOf(this.options.tour, id);
    const { state } = this;
    if (to === null || state.kind === "empty") return;
    if (state.stop === to) this.goOn(nowS);
    else this.leaveFor(to, DIRECT, nowS);
  }

  /** The heights have come: a way that was planned without them is planned anew from where one is. */
  replan(nowS: number): void {
    this.advance(nowS);
    if (this.state.kind === "moving") this.move(this.state.stop, DIRECT, nowS);
  }

  // ---- autoplay ----

  /** Starts autoplay, goes on with a halted way, or begins again after the end. */
  play(nowS: number): void {
    this.advance(nowS);
    const { state } = this;
    if (state.kind === "empty") return;
    this.playing = true;
    if (state.kind === "paused" || state.kind === "look") {
      this.goOn(nowS);
    } else if (state.kind === "stop") {
      const first = firstStop(this.options.tour);
      if (followingStop(this.options.tour, state.stop) !== null) this.state = { ...state, sinceS: nowS };
      else if (first !== null && first !== state.stop) this.leaveFor(first, DIRECT, nowS);
      else this.playing = false;
    }
  }

  /** Halts a way, or keeps autoplay at its stop. */
  pause(nowS: number): void {
    this.advance(nowS);
    const { state } = this;
    if (state.kind === "moving") {
      const { from, stop, route, returning } = state;
      const afterS = Math.max(0, nowS - state.beganS);
      this.state = { kind: "paused", from, stop, route, afterS, wasPlaying: this.playing, returning };
    }
    this.playing = false;
  }

  // ---- looking ----

  /** The person turns the view: degrees to the right and up. A way is broken off there, and autoplay ends. */
  look(dYawDeg: number, dPitchDeg: number, nowS: number): void {
    this.advance(nowS);
    const pose = this.pose(nowS);
    if (pose !== null) this.takeOver(lookedAround(pose, dYawDeg, dPitchDeg));
  }

  /** The person moved the camera to this pose. */
  movedTo(pose: Pose, nowS: number): void {
    this.advance(nowS);
    this.takeOver(pose);
  }

  /** Turns back to the stop's view; from a way that was broken off or halted, goes on to its stop. */
  back(nowS: number): void {
    this.advance(nowS);
    this.goOn(nowS);
  }

  // ---- inside ----

  private takeOver(pose: Pose): void {
    const { state } = this;
    if (state.kind === "empty") return;
    this.playing = false;
    if (state.kind === "look") {
      this.state = { ...state, pose };
      return;
    }
    const arrived = this.here() !== null;
    const from = state.kind === "stop" ? null : state.from;
    this.state = { kind: "look", pose, stop: state.stop, arrived, from };
  }

  /** Branches of the stop where one is. */
  private choices(): readonly (BranchChoice & { readonly path: Path })[] {
    const branches = this.here()?.branches ?? [];
    return branches.flatMap(({ to, label, path }) => {
      const stop = stopOf(this.options.tour, to);
      return stop === null ? [] : [{ label, to: stop, path }];
    });
  }

  /** The stop where one is, whatever one looks at; null: on the way, or nowhere. */
  private here(): Stop | null {
    const { state } = this;
    switch (state.kind) {
      case "empty":
        return null;
      case "stop":
        return state.stop;
      case "moving":
      case "paused":
        return state.returning ? state.stop : null;
      case "look":
        return state.arrived ? state.stop : null;
      default:
        return state satisfies never;
    }
  }

  private pose(nowS: number): Pose | null {
    const { state } = this;
    switch (state.kind) {
      case "empty":
        return null;
      case "stop":
        return poseOf(state.stop.pose);
      case "moving":
        return poseAt(state.route, nowS - state.beganS);
      case "paused":
        return poseAt(state.route, state.afterS);
      case "look":
        return state.pose;
      default:
        return state satisfies never;
    }
  }

  /** What is due by now, one step at most. */
  private advance(nowS: number): void {
    const { state } = this;
    if (state.kind === "moving" && nowS - state.beganS >= state.route.durationS) {
      this.state = { kind: "stop", stop: state.stop, sinceS: nowS, byCut: false };
    } else if (state.kind === "stop" && this.playing && nowS - state.sinceS >= stayS(state)) {
      const to = followingStop(this.options.tour, state.stop);
      if (to === null) this.playing = false;
      else this.leaveFor(to, state.stop.next?.path ?? DIRECT, nowS);
    }
  }

  /** A new way, which `previous` will lead back. */
  private leaveFor(to: Stop, path: Path, nowS: number): void {
    const here = this.here();
    if (here !== null) this.history.push({ stop: here, path });
    // Turned round on the way: one goes to where one came from.
    if (this.history.at(-1)?.stop === to) this.history.pop();
    this.move(to, path, nowS);
  }

  /** With a way that was halted, or from elsewhere to the stop. Else nothing. */
  private goOn(nowS: number): void {
    const { state } = this;
    if (state.kind === "paused") {
      const { from, stop, route, returning } = state;
      this.playing = this.playing || state.wasPlaying;
      this.state = { kind: "moving", from, stop, route, beganS: nowS - state.afterS, returning };
    } else if (state.kind === "look") {
      this.move(state.stop, DIRECT, nowS);
    }
  }

  private move(to: Stop, path: Path, nowS: number): void {
    const pose = this.pose(nowS);
    if (pose === null) return;
    const here = this.here();
    const from = here ?? ("from" in this.state ? this.state.from : null);
    const chosen: Path = this.options.reducedMotion() ? { kind: "jump" } : path;
    const route = planRoute(pose, to.pose, chosen, this.options.heights());
    if (route.durationS > 0) {
      this.state = { kind: "moving", from, stop: to, route, beganS: nowS, returning: here === to };
    } else {
      this.cuts += 1;
      this.state = { kind: "stop", stop: to, sinceS: nowS, byCut: true };
    }
  }

  private describe(nowS: number): PlayerView {
    const { state } = this;
    const { tour } = this.options;
    const count = tour.stops.length;
    if (state.kind === "empty") {
      return {
        phase: "empty",
        pose: null,
        stop: null,
        arrived: false,
        things: thingsAt(tour.things, []),
        progress: { index: 0, count, share: 1 },
        playing: false,
        ended: true,
        cuts: 0,
        can: { next: false, previous: false, play: false, pause: false, back: false, branches: [] },
      };
    }
    const { stop } = state;
    const arrived = this.here() !== null;
    const following = followingStop(tour, stop);
    const from = state.kind === "stop" || arrived ? null : state.from;
    const halted = state.kind === "paused" || state.kind === "look";
    const first = firstStop(tour);
    return {
      phase: state.kind,
      pose: this.pose(nowS),
      stop,
      arrived,
      things: thingsAt(tour.things, [stop, from]),
      progress: { index: tour.stops.indexOf(stop), count, share: this.share(nowS) },
      playing: this.playing,
      ended: arrived && following === null,
      cuts: this.cuts,
      can: {
        next: following !== null || (halted && !arrived),
        previous: this.history.length > 0,
        play: !this.playing && (halted || following !== null || first !== stop),
        pause: this.playing || state.kind === "moving",
        back: halted,
        branches: this.choices(),
      },
    };
  }

  private share(nowS: number): number {
    const { state } = this;
    if (state.kind === "moving") return clamped((nowS - state.beganS) / state.route.durationS);
    if (state.kind === "paused") return clamped(state.afterS / state.route.durationS);
    if (state.kind === "stop" && this.playing) {
      const stay = stayS(state);
      return stay > 0 ? clamped((nowS - state.sinceS) / stay) : 1;
    }
    return 1;
  }
}

function stayS({ stop, byCut }: AtStop): number {
  return byCut ? Math.max(LEAST_STAY_S, stop.pauseS) : stop.pauseS;
}

function clamped(share: number): number {
  return Math.min(1, Math.max(0, share));
}
