// The picture: renderer, the surfaces of both projects, their exact frames over them, and the layers over all. Knows nothing of the store.
import {
  type Camera,
  ColorManagement,
  DoubleSide,
  LinearSRGBColorSpace,
  MeshBasicMaterial,
  NoToneMapping,
  Plane,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import type { Vec2 } from "../base/vec.js";
import type { Which } from "../protocol/link_api.js";
import type { ClipBox, Layers } from "../state/app_state.js";
import type { Project, ProjectBase } from "../state/project.js";
import { BuildingsLayer } from "./buildings_layer.js";
import { clipInScene, halfSpacesOf, swipeColumns } from "./clip.js";
import { ExactLayer } from "./exact_layer.js";
import { ExtraLayers } from "./extra_layers.js";
import type { LoadBytes } from "./load_bytes.js";
import { readModel } from "./model_file.js";
import { ModelStore } from "./model_store.js";
import type { Quality } from "./quality.js";
import type { Surface, SurfaceEvents } from "./surface.js";
import { type Drape, SurfaceStyle } from "./surface_style.js";
import { TerrainLayer } from "./terrain_layer.js";
import { ThingsLayer } from "./things_layer.js";
import { TilesLayer } from "./tiles_layer.js";
import type { Size } from "./view_math.js";
import { NO_WEBGL2, webglSupport } from "./webgl_support.js";
import { type Box, IDENTITY, sceneFromOwnEnu, sceneFromTiles, type World } from "./world.js";

const BACKGROUND = 0x242b33;
const MOST_PIXEL_RATIO = 2;

/** What is drawn of one project. */
interface Side {
  readonly surface: Surface | null;
  readonly scene: Scene;
  readonly exact: ExactLayer;
}

export interface StageOptions {
  readonly project: Project;
  readonly world: World;
  readonly loadBytes: LoadBytes;
  reducedMotion(): boolean;
  events: SurfaceEvents;
}

function makeRenderer(software: boolean): WebGLRenderer {
  // Colours are display values from end to end: what the engine renders and what the photos show.
  ColorManagement.enabled = false;
  let renderer: WebGLRenderer;
  try {
    renderer = new WebGLRenderer({
      antialias: !software,
      alpha: false,
      stencil: false,
      powerPreference: "high-performance",
    });
  } catch {
    throw new Error(NO_WEBGL2);
  }
  renderer.outputColorSpace = LinearSRGBColorSpace;
  renderer.toneMapping = NoToneMapping;
  renderer.autoClear = false;
  renderer.localClippingEnabled = true;
  return renderer;
}

export class Stage {
  readonly renderer: WebGLRenderer;
  readonly extras: ExtraLayers;
  readonly buildings: BuildingsLayer;
  readonly things: ThingsLayer;
  /** The processor draws. */
  readonly software: boolean;
  private readonly world: World;
  private readonly style = new SurfaceStyle();
  private readonly main: Side;
  private readonly before: Side | null;
  private readonly onSurface = new Scene();
  private readonly over = new Scene();
  /** The mesh is not shown, but hides. */
  private readonly unseen = new MeshBasicMaterial({
    colorWrite: false,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
  private readonly depthOnly = new MeshBasicMaterial({ colorWrite: false, side: DoubleSide });
  private clip: Box | null = null;

  /** Throws an Error for the user when the browser has no WebGL 2. */
  constructor(options: StageOptions) {
    const { project, world, events } = options;
    const { software } = webglSupport();
    this.software = software;
    this.world = world;
    this.renderer = makeRenderer(software);
    this.prepare();
    const side = (of: ProjectBase, enuFromOwn: readonly number[]): Side => {
      const surface = this.makeSurface(of, enuFromOwn, options);
      const scene = new Scene();
      if (surface !== null) scene.add(surface.object);
      return { surface, scene, exact: new ExactLayer(world, options.reducedMotion) };
    };
    this.main = side(project, IDENTITY);
    this.before = project.before === null ? null : side(project.before, project.before.enuFromBefore);
    this.extras = new ExtraLayers(project, world, events);
    this.onSurface.add(this.extras.onSurface);
    this.over.add(this.extras.object);
    this.buildings = new BuildingsLayer(world);
    const models = new ModelStore({ loadBytes: options.loadBytes, read: (bytes) => readModel(bytes, software) });
    this.things = new ThingsLayer(world, models, events);
  }

  /** Device pixels per CSS pixel at rest. */
  static fullPixelRatio(): number {
    return Math.min(MOST_PIXEL_RATIO, Math.max(0.5, window.devicePixelRatio || 1));
  }

  /** Device pixels of a canvas of this size, as three.js rounds them. */
  static canvasPx(size: Size, pixelRatio: number): Vec2 {
    return [Math.max(1, Math.floor(size[0] * pixelRatio)), Math.max(1, Math.floor(size[1] * pixelRatio))];
  }

  /** What a new context does not know. */
  prepare(): void {
    this.renderer.setClearColor(BACKGROUND, 1);
  }

  get busy(): boolean {
    return this.main.surface?.busy === true || this.extras.busy || this.things.busy;
  }

  get beforeBusy(): boolean {
    return this.before?.surface?.busy === true;
  }

  get fading(): boolean {
    return this.main.exact.fading || this.before?.exact.fading === true;
  }

  get clipBox(): Box | null {
    return this.clip;
  }

  exact(side: Which): ExactLayer | null {
    return side === "main" ? this.main.exact : (this.before?.exact ?? null);
  }

  surfaces(side: Which): readonly Surface[] {
    const surface = side === "main" ? this.main.surface : this.before?.surface;
    return surface === null || surface === undefined ? [] : [surface];
  }

  eachExact(visit: (exact: ExactLayer) => void): void {
    visit(this.main.exact);
    if (this.before !== null) visit(this.before.exact);
  }

  setClip(clip: ClipBox): void {
    this.clip = clipInScene(this.world, clip);
    const planes =
      this.clip === null
        ? []
        : halfSpacesOf(this.clip).map(({ normal, constant }) => new Plane(new Vector3(...normal), constant));
    this.style.setClip(planes);
    this.unseen.clippingPlanes = planes;
    this.depthOnly.clippingPlanes = planes;
    this.things.setClip(planes);
    this.extras.setClip(clip, planes);
    this.buildings.setClip(planes);
    this.eachExact((exact) => exact.setClip(this.clip));
  }

  setDrape(drape: Drape | null): void {
    this.style.setDrape(drape);
    // The map is of the main project.
    this.main.exact.setDrape(drape);
  }

  /** True when the canvas has another size than before: it is empty then. */
  resize(size: Size, pixelRatio: number): boolean {
    const { renderer } = this;
    const [w, h] = Stage.canvasPx(size, pixelRatio);
    const { width, height } = renderer.domElement;
    if (w === width && h === height && renderer.getPixelRatio() === pixelRatio) return false;
    // Both at once, so that the drawing buffer is made anew only once.
    renderer.setDrawingBufferSize(Math.max(1, size[0]), Math.max(1, size[1]), pixelRatio);
    return true;
  }

  /** The frame of the main project, not its mesh, says what is hidden. Earlier passes only where there is no mesh. */
  get frameHides(): boolean {
    return this.main.exact.hides(this.main.surface === null);
  }

  /** `swipeAt`: null, or where the earlier project ends, 0 to 1 of the width. */
  draw(
    camera: Camera,
    size: Size,
    quality: Quality,
    layers: Pick<Layers, "surface" | "exact">,
    swipeAt: number | null,
  ): void {
    const { renderer, main, before } = this;
    main.surface?.update(camera, size, quality);
    // Also where the line hides it: who moves the line wants to see it at once.
    if (swipeAt !== null) before?.surface?.update(camera, size, quality);
    renderer.setScissorTest(false);
    renderer.clear();
    if (swipeAt !== null && before !== null) {
      const { x, w } = swipeColumns(swipeAt, size[0]).before;
      this.inColumns(x, w, size, () => this.drawSide(before, camera, layers.surface));
    }
    // Right of the line, or everywhere.
    const { x, w } = before === null ? { x: 0, w: size[0] } : swipeColumns(swipeAt ?? 0, size[0]).main;
    this.inColumns(x, w, size, () => this.drawSide(main, camera, layers.surface));
    renderer.render(this.onSurface, camera);
    if (this.things.visible) this.inColumns(x, w, size, () => this.drawThings(camera, layers));
    renderer.render(this.over, camera);
    if (!this.buildings.visible) return;
    // Models of buildings and the surface are centimetres apart and would flicker into each other, so only they and what a tour has placed hide them.
    this.inColumns(x, w, size, () => {
      renderer.clearDepth();
      this.drawDepthOfThings(camera);
      renderer.render(this.buildings.scene, camera);
    });
  }

  dispose(): void {
    for (const side of [this.main, this.before]) {
      side?.exact.dispose();
      side?.surface?.dispose();
    }
    this.extras.dispose();
    this.buildings.dispose();
    this.things.dispose();
    this.unseen.dispose();
    this.depthOnly.dispose();
    this.renderer.dispose();
    // Browsers allow few contexts at a time, and garbage collection takes its time.
    this.renderer.forceContextLoss();
  }

  private inColumns(x: number, w: number, size: Size, draw: () => void): void {
    if (w <= 0) return;
    if (w >= size[0]) {
      draw();
      return;
    }
    this.renderer.setScissor(x, 0, w, size[1]);
    this.renderer.setScissorTest(true);
    draw();
    this.renderer.setScissorTest(false);
  }

  /** Hidden by what the picture shows there: the frame, or the mesh. */
  private drawThings(camera: Camera, layers: Pick<Layers, "surface" | "exact">): void {
    const { renderer, main } = this;
    if (this.frameHides) {
      main.exact.drawDepth(renderer, camera);
    } else if (layers.exact && !layers.surface) {
      // Until the frame comes back: otherwise things would come out of houses whenever the camera moves.
      main.scene.overrideMaterial = this.unseen;
      renderer.render(main.scene, camera);
      main.scene.overrideMaterial = null;
    }
    renderer.render(this.things.scene, camera);
  }

  private drawDepthOfThings(camera: Camera): void {
    if (!this.things.visible) return;
    const { scene } = this.things;
    scene.overrideMaterial = this.depthOnly;
    this.renderer.render(scene, camera);
    scene.overrideMaterial = null;
  }

  private drawSide(side: Side, camera: Camera, showSurface: boolean): void {
    if (showSurface) this.renderer.render(side.scene, camera);
    side.exact.draw(this.renderer, camera);
  }

  private makeSurface(
    project: ProjectBase,
    enuFromOwn: readonly number[],
    { loadBytes, events }: StageOptions,
  ): Surface | null {
    const { style, world, software } = this;
    const { tiles, terrain } = project;
    if (tiles !== null) {
      const fromTiles = sceneFromTiles(world, project, enuFromOwn);
      return new TilesLayer({ url: tiles, sceneFromTiles: fromTiles, style, software, loadBytes }, events);
    }
    if (terrain === null) return null;
    const sceneFromOwn = sceneFromOwnEnu(world, enuFromOwn);
    const maxTexturePx = this.renderer.capabilities.maxTextureSize;
    return new TerrainLayer(
      { ...project, terrain },
      { style, software, maxTexturePx, sceneFromOwn, loadBytes },
      events,
    );
  }
}
