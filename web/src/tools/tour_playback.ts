// Plays the tour in the view: tells the player what time it is and what the person does, moves the camera to where it says, gives each stop its look.
// Whoever takes the view into the hand looks around freely; the next step of the tour begins from there.
import type { Clock } from "../base/clock.js";
import { Disposer } from "../base/disposer.js";
import { angleBetweenRad, norm, sub } from "../base/vec_math.js";
import type { SceneApi } from "../scene/scene_api.js";
import type { AppState, CameraPose } from "../state/app_state.js";
import type { Store } from "../state/store.js";
import type { GroundMap } from "../state/tour_state.js";
import type { Heights } from "../tour/heights.js";
import { TourPlayer } from "../tour/player.js";
import type { PlayerView } from "../tour/player_view.js";
import { StopLook } from "./stop_look.js";

/** What is known of the ground: for ways that keep off it, and for the map. */
export interface Ground {
  readonly heights: Heights | null;
  readonly map: GroundMap | null;
}

export interface PlaybackOptions {
  readonly store: Store;
  readonly scene: Pick<SceneApi, "canvas" | "pose" | "flyTo">;
  readonly clock: Clock;
  /** Draws before the next picture of the screen; returns what prevents it. */
  readonly nextFrame: (draw: () => void) => () => void;
  /** Asked when a tour is played for the first time. */
  readonly ground: () => Promise<Ground>;
  readonly reducedMotion: () => boolean;
}

const NO_GROUND: Ground = { heights: null, map: null };
/** A page that was in the background goes on from where it was. */
const LONGEST_STEP_S = 0.25;
/** While autoplay stays at a stop, and for what is told of how far one is. */
const TELL_MS = 100;
const SAME_PLACE_M = 1e-6;
const SAME_TURN_RAD = 1e-6;

export class TourPlayback {
  private readonly options: PlaybackOptions;
  private player: TourPlayer | null = null;
  private look: StopLook | null = null;
  private before: Pick<AppState, "panel" | "navigation" | "swipe" | "selected"> | null = null;
  private ground: Ground = NO_GROUND;
  private groundAsked = false;
  /** Seconds of playing: time that the page slept does not count. */
  private nowS = 0;
  private lastMs = 0;
  private toldMs = Number.NEGATIVE_INFINITY;
  private told: PlayerView | null = null;
  /** Where the tour has put the camera; another pose is the person's. */
  private put: CameraPose | null = null;
  private cancelNext = (): void => {};
  private hands = new Disposer();

  constructor(options: PlaybackOptions) {
    this.options = options;
  }

  /** From this stop; without one from where the tour begins. */
  play(from?: string): void {
    const { store, scene, clock, reducedMotion } = this.options;
    this.leave();
    const { documents, panel, navigation, swipe, selected } = store.get();
    const { tour } = documents;
    if (tour.stops.length === 0) return;
    this.lastMs = clock.nowMs();
    const heights = () => this.ground.heights;
    this.player = new TourPlayer(
      { tour, heights, reducedMotion, ...(from === undefined ? {} : { at: from }) },
      this.nowS,
    );
    this.before = { panel, navigation, swipe, selected };
    this.look = new StopLook(store);
    // Dragging turns the view where one stands.
    store.set({ tool: "navigate", navigation: "fly", swipe: { ...swipe, on: false }, selected: null });
    for (const type of ["pointerdown", "wheel"] as const) {
      this.hands.listen(scene.canvas, type, () => this.takeOver(true), { passive: true });
    }
    this.hands.add(
      store.subscribe(
        ({ readout }) => readout,
        () => this.takeOver(false),
      ),
    );
    this.askGround();
    this.tick();
  }

  leave(): void {
    if (this.player === null) return;
    this.player = null;
    this.told = null;
    this.put = null;
    this.cancelNext();
    this.hands.dispose();
    this.hands = new Disposer();
    this.look?.restore();
    this.look = null;
    this.options.store.set({ ...(this.before ?? {}), play: null });
    this.before = null;
  }

  next(): void {
    this.act((player, nowS) => player.next(nowS));
  }

  previous(): void {
    this.act((player, nowS) => player.previous(nowS));
  }

  goTo(stop: string): void {
    this.act((player, nowS) => player.goTo(stop, nowS));
  }

  takeBranch(branch: number): void {
    this.act((player, nowS) => player.branch(branch, nowS));
  }

  resume(): void {
    this.act((player, nowS) => player.play(nowS));
  }

  pause(): void {
    this.act((player, nowS) => player.pause(nowS));
  }

  back(): void {
    this.act((player, nowS) => player.back(nowS));
  }

  dispose(): void {
    this.leave();
  }

  private act(change: (player: TourPlayer, nowS: number) => void): void {
    const { player } = this;
    if (player === null) return;
    const nowS = this.passTime();
    // The next way begins where the person has moved the camera.
    if (this.told?.phase === "look") player.movedTo(this.options.scene.pose(), nowS);
    change(player, nowS);
    this.tick();
  }

  /** The person holds the view (`held`), or has moved it. */
  private takeOver(held: boolean): void {
    const { player, told, put } = this;
    if (player === null || told === null || put === null) return;
    const pose = this.options.scene.pose();
    const moved = !samePose(pose, put);
    const going = told.phase === "moving";
    // A hand on a still view moves nothing yet; on the way the tour itself moves it.
    if (going ? !held : told.phase === "look" || !moved) return;
    player.movedTo(pose, this.passTime());
    this.tick();
  }

  private passTime(): number {
    const nowMs = this.options.clock.nowMs();
    this.nowS += Math.min(LONGEST_STEP_S, Math.max(0, (nowMs - this.lastMs) / 1000));
    this.lastMs = nowMs;
    return this.nowS;
  }

  private tick(): void {
    const { player } = this;
    if (player === null) return;
    this.cancelNext();
    const view = player.view(this.passTime());
    this.show(view);
    const { clock, nextFrame } = this.options;
    const again = () => this.tick();
    if (view.phase === "moving") this.cancelNext = nextFrame(again);
    else if (view.playing) this.cancelNext = clock.after(TELL_MS, again);
    else this.cancelNext = () => {};
  }

  private show(view: PlayerView): void {
    const { scene } = this.options;
    // After a look around the camera is not where it was put.
    const put = this.told?.phase === "look" ? null : this.put;
    if (view.pose !== null && view.phase !== "look" && (put === null || !samePose(view.pose, put))) {
      this.put = view.pose;
      void scene.flyTo(view.pose, 0);
    }
    const { told } = this;
    if (view.arrived && view.stop !== null && (told?.arrived !== true || told.stop !== view.stop)) {
      this.look?.apply(view.stop);
    }
    this.tell(view);
  }

  /** At once what changes what can be seen and done; how far one is a few times a second. */
  private tell(view: PlayerView): void {
    const { store, clock } = this.options;
    const { told } = this;
    const nowMs = clock.nowMs();
    const same =
      told !== null &&
      told.phase === view.phase &&
      told.stop === view.stop &&
      told.playing === view.playing &&
      told.can.previous === view.can.previous &&
      told.can.pause === view.can.pause;
    if (same && (told.progress.share === view.progress.share || nowMs - this.toldMs < TELL_MS)) return;
    this.told = view;
    this.toldMs = nowMs;
    const seen = store.get().play?.seen ?? [];
    const id = view.arrived ? (view.stop?.id ?? null) : null;
    const { pose, ...rest } = view;
    store.set({ play: { ...rest, seen: id === null || seen.includes(id) ? seen : [...seen, id] } });
  }

  private askGround(): void {
    if (this.groundAsked) return;
    this.groundAsked = true;
    const { store, ground } = this.options;
    ground().then(
      (found) => {
        this.ground = found;
        store.set({ map: found.map });
        if (found.heights === null || this.player === null) return;
        this.player.replan(this.passTime());
        this.tick();
      },
      // The tour plays without: ways are straight then, and the map is empty.
      () => {},
    );
  }
}

function samePose(a: CameraPose, b: CameraPose): boolean {
  return (
    a.fovyDeg === b.fovyDeg &&
    a.orthoHeightM === b.orthoHeightM &&
    norm(sub(a.eyeEnu, b.eyeEnu)) <= SAME_PLACE_M &&
    angleBetweenRad(a.rotation, b.rotation) <= SAME_TURN_RAD
  );
}
