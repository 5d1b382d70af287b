// What a tour places in the scene, all kinds together: models in three.js, labels and markers over the canvas, and what hides those.
import { Emitter } from "../base/emitter.js";
import type { Vec2, Vec3 } from "../base/vec.js";
import { add, norm, scale, sub } from "../base/vec_math.js";
import type { CameraPose, Enu } from "../state/app_state.js";
import type { CameraRig } from "./camera_rig.js";
import { boxHolds } from "./clip.js";
import { pickSurfaces } from "./picking.js";
import type { Ray } from "./scene_api.js";
import { SightQueue } from "./sight_queue.js";
import type { Stage } from "./stage.js";
import type { ModelThing, SceneThing, TextThing } from "./thing.js";
import { placeOf, ThingsOverlay } from "./things_overlay.js";
import { cameraFromEnu, pixelSizeM } from "./view_math.js";
import { type Box, sceneFromEnu, type World } from "./world.js";

/** Milliseconds of a frame in which is looked for what hides labels and markers. */
const BUDGET_MS = { moving: 4, resting: 16 } as const;
/** A place on the surface is not hidden by the surface around it, whose depth is a little uncertain: metres, and pixels. */
const SLACK_M = 0.25;
const SLACK_PX = 2;

export interface ThingsView {
  readonly showsSurface: boolean;
  /** Exact frames are wanted, so that the mesh hides things even when it is not shown. */
  readonly showsExact: boolean;
  /** Null, or where the earlier project ends, 0 to 1 of the width. */
  readonly swipeAt: number | null;
  readonly moving: boolean;
}

export interface SceneThingsOptions {
  readonly container: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  readonly stage: Stage;
  readonly rig: CameraRig;
  readonly world: World;
  invalidate(): void;
}

export class SceneThings {
  private readonly options: SceneThingsOptions;
  private readonly overlay: ThingsOverlay;
  private readonly queue = new SightQueue();
  private readonly chosen = new Emitter<[string]>();
  private view: ThingsView = { showsSurface: true, showsExact: true, swipeAt: null, moving: false };
  /** On what the findings of the queue depend. */
  private found: readonly unknown[] = [];
  private changes = 0;

  constructor(options: SceneThingsOptions) {
    this.options = options;
    this.overlay = new ThingsOverlay(options.container, options.canvas, (id) => this.chosen.emit(id));
  }

  /** Not everything is found yet. */
  get busy(): boolean {
    return this.queue.busy;
  }

  set(list: readonly SceneThing[]): void {
    const models: ModelThing[] = [];
    const texts: TextThing[] = [];
    for (const thing of list) {
      if (thing.kind === "model") models.push(thing);
      else texts.push(thing);
    }
    this.options.stage.things.set(models);
    if (this.overlay.set(texts)) this.changed();
  }

  highlight(selected: string | null, hovered: string | null): void {
    this.options.stage.things.highlight(selected, hovered);
    this.overlay.highlight(selected, hovered);
  }

  /** A marker was clicked, or chosen by the keyboard. */
  onChosen(listener: (id: string) => void): () => void {
    return this.chosen.on(listener);
  }

  /** Other surfaces or models than before. */
  changed(): void {
    this.changes += 1;
    this.options.invalidate();
  }

  boxOf(id: string): Box | null {
    const text = this.overlay.things.get(id);
    return text === undefined ? this.options.stage.things.boxOf(id) : { min: text.at, max: text.at };
  }

  /** What near and far must hold. */
  corners(): readonly Vec3[] {
    return this.options.stage.things.corners();
  }

  /** Ids of labels and markers that are seen. */
  visibleTexts(): string[] {
    return this.overlay.visible();
  }

  /** Id of what is seen at this place: a label or marker, else the nearest model, when no surface is in front of it. */
  pick(px: Vec2): string | null {
    const text = this.overlay.pick(px);
    if (text !== null) return text;
    const ray = this.options.rig.rayAt(px);
    const hit = this.modelAt(px, ray);
    return hit === null || this.hides(px, ray, hit.t) ? null : hit.id;
  }

  /** Distance along the ray to the nearest model; null: none. */
  modelAt(px: Vec2, ray: Ray): { readonly id: string; readonly t: number } | null {
    if (this.isBefore(px)) return null;
    const { stage, world } = this.options;
    return stage.things.pick(sceneFromEnu(world, ray.originEnu), ray.direction, stage.clipBox);
  }

  /** After each drawn frame. Returns whether another one is needed. */
  update(pose: CameraPose, view: ThingsView): boolean {
    const { rig, stage } = this.options;
    this.view = view;
    const frame = stage.frameHides ? (stage.exact("main")?.frameKey ?? "") : null;
    const { showsSurface, showsExact, swipeAt } = view;
    const now = [rig.version, this.changes, stage.clipBox, frame, showsSurface, showsExact, swipeAt];
    if (now.length !== this.found.length || now.some((value, i) => value !== this.found[i])) {
      this.found = now;
      const near = [...this.overlay.things.values()].filter(({ at }) => placeOf(pose, rig.size, at) !== null);
      this.queue.renew(near.map(({ id }) => id));
    }
    const end = performance.now() + (view.moving ? BUDGET_MS.moving : BUDGET_MS.resting);
    this.queue.step(
      (id) => {
        const thing = this.overlay.things.get(id);
        return thing === undefined || this.isHidden(thing.at, pose);
      },
      () => performance.now() > end,
    );
    this.overlay.update(pose, rig.size, ({ id }) => this.queue.sees(id));
    return this.queue.busy;
  }

  dispose(): void {
    this.overlay.dispose();
    this.chosen.clear();
  }

  private isHidden(at: Enu, pose: CameraPose): boolean {
    const { rig, stage, world } = this.options;
    const px = placeOf(pose, rig.size, at);
    if (px === null || this.isBefore(px)) return true;
    if (stage.clipBox !== null && !boxHolds(stage.clipBox, sceneFromEnu(world, at))) return true;
    const ray = rig.rayAt(px);
    const t = norm(sub(at, ray.originEnu)) - this.slackM(pose, at);
    if (t <= 0) return false;
    const model = stage.things.pick(sceneFromEnu(world, ray.originEnu), ray.direction, stage.clipBox, t);
    return model !== null || this.hides(px, ray, t);
  }

  /** Is what the picture shows of the main project in front of the place `t` along the ray? */
  private hides(px: Vec2, ray: Ray, t: number): boolean {
    const { rig, stage, world } = this.options;
    if (stage.frameHides) {
      const z = stage.exact("main")?.depthAt([px[0] / rig.size[0], px[1] / rig.size[1]]) ?? null;
      if (z !== null) return z < cameraFromEnu(rig.pose, add(ray.originEnu, scale(ray.direction, t)))[2];
    }
    const { showsSurface, showsExact } = this.view;
    if (!showsSurface && (stage.frameHides || !showsExact)) return false;
    const origin = sceneFromEnu(world, ray.originEnu);
    return pickSurfaces(stage.surfaces("main"), origin, ray.direction, stage.clipBox, t) !== null;
  }

  private slackM(pose: CameraPose, at: Enu): number {
    const { rig, world } = this.options;
    const depthM = cameraFromEnu(pose, at)[2];
    return Math.min(SLACK_M, 1e-3 * world.sizeM) + SLACK_PX * pixelSizeM(pose, rig.size, depthM);
  }

  /** The earlier project, which has no things, is shown there. */
  private isBefore(px: Vec2): boolean {
    const { swipeAt } = this.view;
    return swipeAt !== null && px[0] < swipeAt * this.options.rig.size[0];
  }
}
