// What is drawn besides the surface: blocks, cameras, sparse points, contours and the edges of the clip box. Each is made when it is first shown.
import {
  BufferAttribute,
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  type Material,
  type Object3D,
  type Plane,
  Points,
  PointsMaterial,
} from "three";
import { parseJson } from "../base/check.js";
import type { ClipBox, Layers } from "../state/app_state.js";
import type { Project } from "../state/project.js";
import { boxEdges, frustumDepthM, frustumEdges } from "./line_shapes.js";
import { parseContours, parsePoints } from "./points_file.js";
import { sceneFromEnu, type World } from "./world.js";

type LayerName = "blocks" | "cameras" | "points" | "contours";

export interface ExtraEvents {
  changed(): void;
  failed(text: string): void;
}

const COLOURS = {
  block: 0x5ab0ff,
  empty: 0x8a96a3,
  camera: 0xffc94d,
  heldOut: 0xff6bd6,
  contour: 0xd9c8a5,
  index: 0xfff3d6,
  clip: 0xff8c42,
} as const;

function lines(positions: ArrayLike<number>, color: number): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(positions), 3));
  return new LineSegments(geometry, new LineBasicMaterial({ color, toneMapped: false }));
}

export class ExtraLayers {
  /** Points and contours: they lie in the surface, whose own depth hides them. */
  readonly onSurface = new Group();
  /** What stands in space. */
  readonly object = new Group();
  private readonly project: Project;
  private readonly world: World;
  private readonly events: ExtraEvents;
  private readonly abort = new AbortController();
  private readonly made = new Map<LayerName, Group>();
  private readonly loading = new Set<LayerName>();
  private clipEdges: LineSegments | null = null;
  private planes: Plane[] = [];

  constructor(project: Project, world: World, events: ExtraEvents) {
    this.project = project;
    this.world = world;
    this.events = events;
  }

  get busy(): boolean {
    return this.loading.size > 0;
  }

  show(layers: Layers): void {
    for (const name of ["blocks", "cameras", "points", "contours"] as const) {
      if (layers[name] && !this.made.has(name)) this.make(name);
      const group = this.made.get(name);
      if (group !== undefined) group.visible = layers[name];
    }
  }

  /** Points and contours are clipped as the surface is; cameras and boxes say where they are, so they are not. */
  setClip(clip: ClipBox, planes: Plane[]): void {
    this.planes = planes;
    for (const name of ["points", "contours"] as const) {
      this.made.get(name)?.traverse((object) => {
        for (const material of materialsOf(object)) material.clippingPlanes = planes;
      });
    }
    if (this.clipEdges !== null) {
      disposeObject(this.clipEdges);
      this.clipEdges = null;
    }
    if (planes.length === 0) return;
    this.clipEdges = lines(boxEdges(clip, this.world.anchor), COLOURS.clip);
    this.object.add(this.clipEdges);
  }

  dispose(): void {
    this.abort.abort();
    for (const child of [...this.object.children, ...this.onSurface.children]) disposeObject(child);
    this.made.clear();
    this.clipEdges = null;
  }

  private make(name: LayerName): void {
    const group = new Group();
    this.made.set(name, group);
    (name === "points" || name === "contours" ? this.onSurface : this.object).add(group);
    switch (name) {
      case "blocks":
        this.addBlocks(group);
        return;
      case "cameras":
        this.addCameras(group);
        return;
      case "points":
        void this.load(name, group, this.project.points, "sparse points", async (response) =>
          this.addPoints(group, await response.arrayBuffer()),
        );
        return;
      case "contours":
        void this.load(name, group, this.project.contours, "contours", async (response) =>
          this.addContours(group, await response.text()),
        );
        return;
      default: {
        const never: never = name;
        throw new Error(`unknown layer ${String(never)}`);
      }
    }
  }

  private addBlocks(group: Group): void {
    const { blocks } = this.project;
    for (const empty of [false, true]) {
      const positions = blocks
        .filter((block) => block.empty === empty)
        .flatMap((block) => boxEdges(block, this.world.anchor));
      if (positions.length > 0) group.add(lines(positions, empty ? COLOURS.empty : COLOURS.block));
    }
  }

  private addCameras(group: Group): void {
    const { photos, cameras } = this.project;
    const depthM = frustumDepthM(photos, this.world.sizeM);
    for (const heldOut of [false, true]) {
      const positions: number[] = [];
      for (const photo of photos) {
        const camera = cameras[photo.camera];
        if (photo.isTest !== heldOut || camera === undefined) continue;
        for (const value of frustumEdges(photo, camera, depthM, this.world.anchor)) positions.push(value);
      }
      if (positions.length > 0) group.add(lines(positions, heldOut ? COLOURS.heldOut : COLOURS.camera));
    }
  }

  private addPoints(group: Group, bytes: ArrayBuffer): void {
    const { anchor, positions, colours } = parsePoints(bytes);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("color", new BufferAttribute(colours, 3, true));
    const points = new Points(
      geometry,
      new PointsMaterial({ size: 2, sizeAttenuation: false, vertexColors: true, toneMapped: false }),
    );
    points.position.set(...sceneFromEnu(this.world, anchor));
    points.material.clippingPlanes = this.planes;
    group.add(points);
  }

  private addContours(group: Group, text: string): void {
    const { plain, index } = parseContours(parseJson(text, "contours.json"), this.project, this.world.anchor);
    for (const [positions, color] of [
      [plain, COLOURS.contour],
      [index, COLOURS.index],
    ] as const) {
      if (positions.length === 0) continue;
      const piece = lines(positions, color);
      for (const material of materialsOf(piece)) material.clippingPlanes = this.planes;
      group.add(piece);
    }
  }

  private async load(
    name: LayerName,
    group: Group,
    url: string | null,
    what: string,
    add: (response: Response) => Promise<void>,
  ): Promise<void> {
    // Panels offer only layers that exist.
    if (url === null) return;
    const { signal } = this.abort;
    this.loading.add(name);
    try {
      const response = await fetch(url, { signal, credentials: "same-origin" });
      if (!response.ok) throw new Error(`the server answers ${response.status}`);
      await add(response);
      if (signal.aborted) disposeObject(group);
    } catch (error) {
      if (signal.aborted) return;
      // Switching the layer off and on tries again.
      this.made.delete(name);
      group.removeFromParent();
      this.events.failed(`The ${what} cannot be shown: ${error instanceof Error ? error.message : String(error)}`);
    } finally {
      this.loading.delete(name);
      if (!signal.aborted) this.events.changed();
    }
  }
}

function materialsOf(object: Object3D): Material[] {
  if (!(object instanceof LineSegments || object instanceof Points)) return [];
  const material: Material | Material[] = object.material;
  return Array.isArray(material) ? material : [material];
}

function disposeObject(object: Object3D): void {
  object.traverse((part) => {
    if (part instanceof LineSegments || part instanceof Points) part.geometry.dispose();
    for (const material of materialsOf(part)) material.dispose();
  });
  object.removeFromParent();
}
