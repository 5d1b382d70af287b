// The models of a tour: keeps three.js objects in step with the list of things. What hides them is in the depth buffer already when they are drawn.
import { Group, type Material, Mesh, type Object3D, type Plane, Scene } from "three";
import type { Vec3 } from "../base/vec.js";
import type { Model } from "./model.js";
import { modelLight } from "./model_look.js";
import type { ModelStore } from "./model_store.js";
import { pickMeshes } from "./picking.js";
import { matrixOf } from "./surface_style.js";
import type { ModelThing } from "./thing.js";
import { byId, changesBetween } from "./thing_changes.js";
import { type Outline, outlineOf } from "./thing_outline.js";
import { boxThrough, enuFromModel, sceneFromModel } from "./thing_transform.js";
import type { Box, World } from "./world.js";

/** Near and far of the camera hold models up to this many sizes of the scene outside it. */
const FARTHEST_SIZES = 10;

export interface ThingsEvents {
  /** Another picture than before. */
  changed(): void;
  /** For the user; once for each model that cannot be shown. */
  failed(text: string): void;
}

interface Shown {
  readonly group: Group;
  thing: ModelThing;
  model: Model | null;
  release: () => void;
}

export class ThingsLayer {
  readonly scene = new Scene();
  private readonly world: World;
  private readonly store: ModelStore;
  private readonly events: ThingsEvents;
  private readonly shown = new Map<string, Shown>();
  private list: ReadonlyMap<string, ModelThing> = new Map();
  private planes: Plane[] = [];
  private selected: string | null = null;
  private hovered: string | null = null;
  private outlines: Outline[] = [];
  /** Corners of all boxes, until one changes. */
  private around: Vec3[] | null = null;
  /** Of models that could not be shown: said once, also when they come and go. */
  private readonly said = new Set<string>();

  /** Owns the store. */
  constructor(world: World, store: ModelStore, events: ThingsEvents) {
    this.world = world;
    this.store = store;
    this.events = events;
    this.scene.add(modelLight());
  }

  /** There is something to draw. */
  get visible(): boolean {
    for (const { model } of this.shown.values()) if (model !== null) return true;
    return false;
  }

  get busy(): boolean {
    return this.store.busy;
  }

  set(list: readonly ModelThing[]): void {
    const next = byId(list);
    const { added, removed, changed } = changesBetween(this.list, next);
    this.list = next;
    if (added.length === 0 && removed.length === 0 && changed.length === 0) return;
    // First what is new, so that a file that both lists show is not loaded again.
    for (const thing of added) this.add(thing);
    for (const { before, after } of changed) {
      const shown = this.shown.get(after.id);
      if (shown === undefined) continue;
      shown.thing = after;
      if (before.url !== after.url) this.reload(shown);
      this.place(shown);
    }
    for (const { id } of removed) this.remove(id);
    this.outline();
    this.events.changed();
  }

  /** Ids; null: none. */
  highlight(selected: string | null, hovered: string | null): void {
    if (selected === this.selected && hovered === this.hovered) return;
    this.selected = selected;
    this.hovered = hovered;
    this.outline();
    this.events.changed();
  }

  setClip(planes: Plane[]): void {
    this.planes = planes;
    this.clip(this.scene);
  }

  /** The box around a model, ENU; null: it is not there (yet). */
  boxOf(id: string): Box | null {
    const shown = this.shown.get(id);
    return shown === undefined || shown.model === null ? null : boxThrough(enuFromModel(shown.thing), shown.model.box);
  }

  /** Corners of all boxes, ENU; what is very far away counts as less far, as one such model would cost all others their depth. */
  corners(): readonly Vec3[] {
    this.around ??= [...this.shown.keys()].flatMap((id) => {
      const box = this.boxOf(id);
      return box === null ? [] : [this.within(box.min), this.within(box.max)];
    });
    return this.around;
  }

  /** The first model along the ray (scene coordinates, unit direction) nearer than `limit`; null: none. With a clip box only what is inside counts. */
  pick(
    origin: Vec3,
    direction: Vec3,
    clip: Box | null,
    limit = Number.POSITIVE_INFINITY,
  ): { readonly id: string; readonly t: number } | null {
    let nearest: { id: string; t: number } | null = null;
    for (const [id, { group, model }] of this.shown) {
      if (model === null) continue;
      const meshes = [
        { eachMesh: (visit: (mesh: Mesh, geometry: Mesh["geometry"]) => void) => eachMesh(group, visit) },
      ];
      const t = pickMeshes(meshes, origin, direction, { clip, limit: nearest?.t ?? limit, sides: "both" });
      if (t !== null) nearest = { id, t };
    }
    return nearest;
  }

  dispose(): void {
    this.list = new Map();
    for (const id of [...this.shown.keys()]) this.remove(id);
    this.outline();
    this.store.dispose();
  }

  private add(thing: ModelThing): void {
    const group = new Group();
    group.matrixAutoUpdate = false;
    this.scene.add(group);
    const shown: Shown = { group, thing, model: null, release: () => {} };
    this.shown.set(thing.id, shown);
    this.place(shown);
    this.acquire(shown);
  }

  private remove(id: string): void {
    const shown = this.shown.get(id);
    if (shown === undefined) return;
    this.shown.delete(id);
    this.around = null;
    shown.group.clear();
    shown.group.removeFromParent();
    shown.release();
  }

  private reload(shown: Shown): void {
    const { release } = shown;
    this.acquire(shown);
    release();
    shown.group.clear();
    shown.model = null;
  }

  private acquire(shown: Shown): void {
    const { url } = shown.thing;
    shown.release = this.store.acquire(url, (outcome) => {
      if (outcome instanceof Error) {
        const text = `The model "${shown.thing.name}" cannot be shown: ${outcome.message}.`;
        if (!this.said.has(text)) this.events.failed(text);
        this.said.add(text);
      } else {
        this.around = null;
        shown.model = outcome;
        const copy = outcome.object.clone(true);
        this.clip(copy);
        shown.group.add(copy);
        shown.group.updateMatrixWorld(true);
        this.outline();
      }
      this.events.changed();
    });
  }

  private within(p: Vec3): Vec3 {
    const { boxEnu, sizeM } = this.world;
    const { min, max } = boxEnu;
    const reach = FARTHEST_SIZES * sizeM;
    const clamp = (i: 0 | 1 | 2) => Math.min(max[i] + reach, Math.max(min[i] - reach, p[i]));
    return [clamp(0), clamp(1), clamp(2)];
  }

  private place({ group, thing }: Shown): void {
    this.around = null;
    group.matrix.copy(matrixOf(sceneFromModel(this.world, thing)));
    group.matrixWorldNeedsUpdate = true;
    group.updateMatrixWorld(true);
  }

  private outline(): void {
    for (const outline of this.outlines.splice(0)) outline.dispose();
    for (const [id, colour] of [
      [this.selected, "selected"],
      [this.hovered === this.selected ? null : this.hovered, "hovered"],
    ] as const) {
      const shown = id === null ? undefined : this.shown.get(id);
      if (shown === undefined || shown.model === null) continue;
      const outline = outlineOf(shown.model.box, colour);
      this.clip(outline.object);
      shown.group.add(outline.object);
      outline.object.updateMatrixWorld(true);
      this.outlines.push(outline);
    }
  }

  private clip(object: Object3D): void {
    object.traverse((child) => {
      if (!("material" in child)) return;
      const { material } = child as Object3D & { readonly material: Material | Material[] };
      for (const one of Array.isArray(material) ? material : [material]) one.clippingPlanes = this.planes;
    });
  }
}

function eachMesh(object: Object3D, visit: (mesh: Mesh, geometry: Mesh["geometry"]) => void): void {
  object.traverse((child) => {
    if (child instanceof Mesh) visit(child, child.geometry);
  });
}
