// The 3-D view: joins camera, surfaces, exact frames, navigation and marks, and keeps them in step with the store and the engine.
import { systemClock } from "../base/clock.js";
import { Disposer } from "../base/disposer.js";
import type { Vec2, Vec3 } from "../base/vec.js";
import { add, scale } from "../base/vec_math.js";
import type { Link } from "../protocol/link_api.js";
import type { AppState, CameraPose, Enu, SurfacePoint } from "../state/app_state.js";
import { shownMap } from "../state/layers.js";
import { addNotice } from "../state/notices.js";
import type { Project } from "../state/project.js";
import type { Store } from "../state/store.js";
import { boxWith, cornersOfBefore } from "./boxes.js";
import { watchBuildings } from "./buildings_layer.js";
import { CameraMoves } from "./camera_moves.js";
import { CameraRig } from "./camera_rig.js";
import { watchContext } from "./context_loss.js";
import { ExactControl } from "./exact_control.js";
import { obliquePose, topPose } from "./framing.js";
import { fetchBytes, type LoadBytes } from "./load_bytes.js";
import { MapDrape } from "./map_drape.js";
import { MiddleCross } from "./middle_cross.js";
import { Navigation } from "./navigation.js";
import { Overlay } from "./overlay.js";
import { Places } from "./places.js";
import { FrameMeter } from "./quality.js";
import { ReadoutWriter } from "./readout.js";
import { RenderLoop } from "./render_loop.js";
import type { Ray, SceneApi } from "./scene_api.js";
import { SceneThings } from "./scene_things.js";
import { Stage } from "./stage.js";
import type { SceneThing } from "./thing.js";
import type { Size } from "./view_math.js";
import { type Box, makeWorld, type World } from "./world.js";

export interface SceneOptions {
  readonly container: HTMLElement;
  readonly project: Project;
  readonly store: Store;
  readonly link: Link;
  /** Where surface and models come from; without it from the server. */
  readonly loadBytes?: LoadBytes;
}

/** Throws an Error for the user when the browser has no WebGL 2. */
export function createScene(options: SceneOptions): SceneApi {
  return new ViewerScene(options);
}

/** Frames after a pause do not make keys jump. */
const LONGEST_STEP_MS = 100;
const USUAL_STEP_MS = 16;

class ViewerScene implements SceneApi {
  readonly canvas: HTMLCanvasElement;
  private readonly store: Store;
  private readonly world: World;
  private readonly disposer = new Disposer();
  private readonly stage: Stage;
  private readonly rig: CameraRig;
  private readonly loop: RenderLoop;
  private readonly meter: FrameMeter;
  private readonly moves: CameraMoves;
  private readonly navigation: Navigation;
  private readonly exact: ExactControl;
  private readonly overlay: Overlay;
  private readonly readout: ReadoutWriter;
  private readonly drape: MapDrape;
  private readonly places: Places;
  private readonly things: SceneThings;
  private readonly photosBox: Box;
  private readonly before: readonly Vec3[];
  private drawnVersion = -1;
  private drawnRatio = 0;
  private lastFrameMs = Number.NEGATIVE_INFINITY;
  private waiters: { readonly after: number; readonly done: () => void }[] = [];

  constructor({ container, project, store, link, loadBytes = fetchBytes }: SceneOptions) {
    this.store = store;
    this.world = makeWorld(project);
    const positions = project.photos.map(({ position }) => position);
    this.photosBox = boxWith(this.world.boxEnu, positions);
    this.before = cornersOfBefore(project);
    const d = this.disposer;
    const motion = window.matchMedia("(prefers-reduced-motion: reduce)");
    const reducedMotion = () => motion.matches;
    const invalidate = () => this.loop.invalidate();
    const changed = () => this.things.changed();
    const failed = (text: string) => {
      addNotice(store, "error", text);
    };
    this.loop = d.own(new RenderLoop((nowMs) => this.frame(nowMs)));
    this.stage = d.own(
      new Stage({ project, world: this.world, loadBytes, reducedMotion, events: { changed, failed } }),
    );
    this.canvas = this.stage.renderer.domElement;
    this.meter = new FrameMeter(this.stage.software);
    placeCanvas(
      container,
      this.canvas,
      `3-D view of ${project.name}: drag moves, right button turns, wheel zooms, arrow keys move`,
    );
    d.add(() => this.canvas.remove());
    const size: Size = [container.clientWidth, container.clientHeight];
    const top = store.get().navigation === "top";
    const first = top ? topPose(this.world.boxEnu, size, this.world) : obliquePose(this.world.boxEnu, size);
    this.rig = new CameraRig(this.world, first);
    this.rig.resize(size);
    this.overlay = d.own(new Overlay(container, project, this.world.sizeM));
    d.own(new MiddleCross(container, store));
    const { world, rig, stage, canvas } = this;
    this.places = new Places({ rig, stage, world, swipeAt: () => this.swipeAt() });
    this.things = d.own(new SceneThings({ container, canvas, stage, rig, world, invalidate }));
    const focus = () => this.places.focus();
    this.moves = d.own(new CameraMoves({ rig, world, store, reducedMotion, focus, invalidate }));
    this.navigation = d.own(
      new Navigation({
        canvas: this.canvas,
        rig,
        world,
        mode: () => store.get().navigation,
        reducedMotion,
        pick: (px) => this.pickSurface(px)?.enu ?? null,
        groundAt: (x, y) => this.places.groundAt(x, y),
        onInput: () => this.moves.interrupt(),
        invalidate,
      }),
    );
    this.exact = d.own(
      new ExactControl({
        project,
        store,
        link,
        rig,
        clock: systemClock,
        layer: (side) => this.stage.exact(side),
        canvasPx: () => Stage.canvasPx(rig.size, Stage.fullPixelRatio()),
        drawn: () => rig.version === this.drawnVersion,
        invalidate,
      }),
    );
    this.readout = d.own(new ReadoutWriter(store, systemClock, () => this.places.readout(this.meter.fps)));
    this.drape = d.own(
      new MapDrape(world, {
        changed: (drape) => {
          this.stage.setDrape(drape);
          invalidate();
        },
        failed,
      }),
    );
    this.listen(container);
    this.loop.invalidate();
  }

  // ---- what scene_api.ts offers ----

  pose(): CameraPose {
    return this.rig.pose;
  }

  flyTo(pose: CameraPose, durationMs?: number): Promise<void> {
    this.navigation.stop();
    return this.moves.flyTo(pose, durationMs);
  }

  frameBox(min: Enu, max: Enu): Promise<void> {
    this.navigation.stop();
    return this.moves.frameBox(min, max);
  }

  rayAt(px: Vec2): Ray {
    return this.rig.rayAt(px);
  }

  pickSurface(px: Vec2): SurfacePoint | null {
    return this.places.surface(px);
  }

  pickBuilding(px: Vec2): number | null {
    return this.places.building(px);
  }

  setThings(list: readonly SceneThing[]): void {
    this.things.set(list);
  }

  highlightThings(selected: string | null, hovered: string | null): void {
    this.things.highlight(selected, hovered);
  }

  onThingChosen(listener: (id: string) => void): () => void {
    return this.things.onChosen(listener);
  }

  pickThing(px: Vec2): string | null {
    return this.things.pick(px);
  }

  pickPlace(px: Vec2): SurfacePoint | null {
    return this.places.surfaceOr(px, this.things.modelAt(px, this.rig.rayAt(px))?.t ?? null);
  }

  boxOfThing(id: string): Box | null {
    return this.things.boxOf(id);
  }

  visibleTexts(): readonly string[] {
    return this.things.visibleTexts();
  }

  project(point: Enu): Vec2 | null {
    return this.rig.project(point);
  }

  invalidate(): void {
    this.loop.invalidate();
  }

  whenIdle(): Promise<void> {
    if (this.disposer.disposed) return Promise.resolve();
    return new Promise((done) => {
      this.waiters.push({ after: this.loop.drawn, done });
      this.loop.invalidate();
    });
  }

  capture(): Promise<Blob> {
    // Read in the same task as it is drawn: the drawing buffer is empty afterwards.
    this.loop.drawNow();
    return new Promise((resolve, reject) => {
      this.canvas.toBlob((blob) => {
        if (blob === null) reject(new Error("the browser made no picture of the view"));
        else resolve(blob);
      }, "image/png");
    });
  }

  dispose(): void {
    this.disposer.dispose();
    for (const { done } of this.waiters.splice(0)) done();
  }

  // ---- frames ----

  private frame(nowMs: number): boolean {
    const { rig, stage, store, meter } = this;
    const passed = nowMs - this.lastFrameMs;
    const stepMs = passed > 2 * LONGEST_STEP_MS ? USUAL_STEP_MS : Math.min(LONGEST_STEP_MS, Math.max(0, passed));
    this.lastFrameMs = nowMs;
    this.moves.step(nowMs);
    if (!this.moves.active) this.navigation.step(stepMs);
    const fullRatio = Stage.fullPixelRatio();
    const moved = rig.version !== this.drawnVersion;
    if (moved || fullRatio !== this.drawnRatio) {
      this.drawnVersion = rig.version;
      this.drawnRatio = fullRatio;
      this.exact.renew();
    }
    // Also when only tiles arrived: they tell how large a pixel is.
    this.readout.changed();
    meter.frame(nowMs, moved);
    stage.eachExact((exact) => exact.step(nowMs));
    const state = store.get();
    const quality = meter.quality(!this.exact.resting);
    stage.resize(rig.size, Math.min(fullRatio, quality.pixelRatio));
    const swipeAt = this.swipeAt();
    stage.draw(rig.update(this.visibleBox(state)), rig.size, quality, state.layers, swipeAt);
    this.overlay.update(state, rig.pose, rig.size);
    const { surface: showsSurface, exact: showsExact } = state.layers;
    const looking = this.things.update(rig.pose, { showsSurface, showsExact, swipeAt, moving: moved });
    const again = this.moves.active || this.navigation.active || stage.fading || looking;
    if (!again) this.tellIdle();
    return again;
  }

  /** Those who wait for a still picture, when nothing more will change it. */
  private tellIdle(): void {
    if (this.waiters.length === 0 || this.loop.pending || this.stage.busy || this.drape.busy) return;
    if (this.exact.swiping && this.stage.beforeBusy) return;
    // While moving less may be drawn than at rest.
    if (!this.exact.resting && this.meter.quality(true) !== this.meter.quality(false)) return;
    const waiters = this.waiters.filter(({ after }) => this.loop.drawn >= after);
    this.waiters = this.waiters.filter((waiter) => !waiters.includes(waiter));
    for (const { done } of waiters) done();
  }

  /** All that near and far must hold. */
  private visibleBox(state: AppState): Box {
    const margin = 0.05 * this.world.sizeM;
    let box = this.world.boxEnu;
    if (state.layers.cameras) box = boxWith(box, [this.photosBox.min, this.photosBox.max]);
    if (this.stage.clipBox !== null) box = boxWith(box, [state.clip.min, state.clip.max]);
    if (this.exact.swiping) box = boxWith(box, this.before);
    box = boxWith(box, this.things.corners());
    const by: Vec3 = [margin, margin, margin];
    return { min: add(box.min, scale(by, -1)), max: add(box.max, by) };
  }

  /** Null, or where the earlier project ends, 0 to 1 of the width. */
  private swipeAt(): number | null {
    return this.exact.swiping ? this.store.get().swipe.at : null;
  }

  // ---- store and window ----

  private listen(container: HTMLElement): void {
    const { disposer: d, store, stage } = this;
    const invalidate = () => this.loop.invalidate();
    const resized = new ResizeObserver(() => {
      this.rig.resize([container.clientWidth, container.clientHeight]);
      invalidate();
    });
    resized.observe(container);
    d.add(() => resized.disconnect());
    d.listen(window, "resize", invalidate);
    d.add(
      watchContext(this.canvas, store, this.loop, () => {
        stage.prepare();
        this.exact.reset();
      }),
    );
    d.add(
      store.subscribe(
        (state) => state.layers,
        (layers) => {
          stage.extras.show(layers);
          invalidate();
        },
      ),
    );
    d.add(
      store.subscribe(
        (state) => state.clip,
        (clip) => {
          stage.setClip(clip);
          invalidate();
        },
      ),
    );
    d.add(store.subscribe(shownMap, (map) => this.drape.show(map)));
    d.add(watchBuildings(store, stage.buildings, invalidate));
    d.add(store.subscribe((state) => state.swipe, invalidate));
    d.add(
      store.subscribe(
        (state) => state.navigation,
        (mode) => {
          this.navigation.stop();
          this.moves.setMode(mode);
        },
      ),
    );
    d.add(
      store.subscribeAll(() => {
        if (this.overlay.needs(store.get())) invalidate();
      }),
    );
    const state = store.get();
    stage.extras.show(state.layers);
    stage.setClip(state.clip);
    this.drape.show(shownMap(state));
  }
}

function placeCanvas(container: HTMLElement, canvas: HTMLCanvasElement, label: string): void {
  canvas.tabIndex = 0;
  canvas.className = "scene-canvas";
  canvas.setAttribute("role", "application");
  canvas.setAttribute("aria-label", label);
  const { style } = canvas;
  style.position = "absolute";
  style.left = "0";
  style.top = "0";
  style.width = "100%";
  style.height = "100%";
  style.display = "block";
  // Fingers move the camera, not the page.
  style.touchAction = "none";
  container.append(canvas);
}
