// The exact frame of one project: the engine's picture over the mesh. At the frame's own pose it is a quad over the whole canvas, pixel by pixel; while
// the camera moves away it is its depth grid and fades. The mesh shows through the holes.
import {
  BufferAttribute,
  BufferGeometry,
  type Camera,
  DataTexture,
  FloatType,
  LinearFilter,
  Mesh,
  NearestFilter,
  RedFormat,
  Scene,
  type Texture,
  type WebGLRenderer,
} from "three";
import type { Vec2 } from "../base/vec.js";
import { matrixFromQuat } from "../base/vec_math.js";
import type { ExactFrame } from "../protocol/link_api.js";
import { boxHolds } from "./clip.js";
import { makeDepthGrid } from "./depth_grid.js";
import { type ExactUniforms, makeExactMaterial, makeExactUniforms, setDefines } from "./exact_material.js";
import { Fade } from "./fade.js";
import { FrameDepthMaterial } from "./frame_depth.js";
import { depthInFrame, pointOfFrame } from "./frame_sight.js";
import { type Drape, matrixOf, textureOf } from "./surface_style.js";
import { type Box, sceneFromEnu, type World } from "./world.js";

interface Shown {
  readonly frame: Omit<ExactFrame, "bitmap">;
  readonly colour: Texture;
  depth: DataTexture | null;
}

/** Camera axes x right, y down, z ahead into the scene, 16 numbers row by row. */
function sceneFromCamera(world: World, frame: Pick<ExactFrame, "eyeEnu" | "rotation">): number[] {
  const [eye, r] = [sceneFromEnu(world, frame.eyeEnu), matrixFromQuat(frame.rotation)];
  // cam_from_enu transposed.
  const row = (i: number) => [r[i] ?? 0, r[i + 3] ?? 0, r[i + 6] ?? 0, eye[i] ?? 0];
  return [...row(0), ...row(1), ...row(2), 0, 0, 0, 1];
}

/** One triangle that holds the whole canvas. */
function canvasTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
  return geometry;
}

export class ExactLayer {
  private readonly world: World;
  private readonly reducedMotion: () => boolean;
  private readonly uniforms: ExactUniforms = makeExactUniforms();
  private readonly scene = new Scene();
  private readonly quad: Mesh<BufferGeometry, ReturnType<typeof makeExactMaterial>>;
  private readonly grid: Mesh<BufferGeometry, ReturnType<typeof makeExactMaterial>>;
  private readonly depthScene = new Scene();
  private readonly depthQuad: Mesh<BufferGeometry, FrameDepthMaterial>;
  private readonly fade = new Fade();
  private shown: Shown | null = null;
  /** The camera is where the frame was rendered. */
  private atPose = false;
  private gridOf: Shown | null = null;
  private drape: Drape | null = null;
  private clip: Box | null = null;

  constructor(world: World, reducedMotion: () => boolean) {
    this.world = world;
    this.reducedMotion = reducedMotion;
    this.quad = new Mesh(canvasTriangle(), makeExactMaterial("quad", this.uniforms));
    this.grid = new Mesh(new BufferGeometry(), makeExactMaterial("grid", this.uniforms));
    this.depthQuad = new Mesh(this.quad.geometry, new FrameDepthMaterial(this.uniforms));
    for (const mesh of [this.quad, this.grid, this.depthQuad]) {
      mesh.frustumCulled = false;
      mesh.matrixAutoUpdate = false;
    }
    this.scene.add(this.quad, this.grid);
    this.depthScene.add(this.depthQuad);
  }

  /** It still changes by itself. */
  get fading(): boolean {
    return this.fade.active;
  }

  get opacity(): number {
    return this.fade.opacity;
  }

  /** At the frame's own pose and fully there: what is below it cannot be seen, apart from holes that the clip box makes. */
  get settled(): boolean {
    return this.atPose && this.fade.opacity === 1;
  }

  /**
   * The frame, no longer the mesh, says what hides things: it is at its own pose and more there than the mesh. Until its last pass its depth is coarser
   * than the mesh; `coarse` takes it all the same.
   */
  hides(coarse: boolean): boolean {
    if (this.shown === null || !this.atPose || this.fade.opacity < 0.5) return false;
    const { pass, passes, depthWidth, depthHeight, depthM } = this.shown.frame;
    return (coarse || pass >= passes - 1) && depthWidth > 0 && depthM.length >= depthWidth * depthHeight;
  }

  /** Which frame is shown. */
  get frameKey(): string {
    return this.shown === null ? "" : `${this.shown.frame.seq}/${this.shown.frame.pass}`;
  }

  /** z along the optical axis at a place of the canvas, 0 to 1; infinity: no surface; null: there is no frame there, so that the mesh is seen. */
  depthAt(place: Vec2): number | null {
    if (this.shown === null) return null;
    const { frame } = this.shown;
    const z = depthInFrame(frame, place);
    if (this.clip === null) return z;
    const inside = Number.isFinite(z) && boxHolds(this.clip, sceneFromEnu(this.world, pointOfFrame(frame, place, z)));
    return inside ? z : null;
  }

  /** Writes the frame's depth for what is drawn next. The scissor of the caller holds. */
  drawDepth(renderer: WebGLRenderer, camera: Camera): void {
    if (this.shown === null) return;
    this.uploadDepth(this.shown);
    this.depthQuad.material.prepare(camera, this.clip !== null);
    renderer.render(this.depthScene, camera);
  }

  /** A frame of the pose at which the camera is; takes its bitmap over. `canvasPx`: device pixels of the canvas. */
  show(frame: ExactFrame, canvasPx: Vec2): void {
    const { bitmap, ...rest } = frame;
    const later = this.shown !== null && this.shown.frame.seq === frame.seq && this.atPose;
    const colour = textureOf(bitmap);
    const exact = frame.width === canvasPx[0] && frame.height === canvasPx[1];
    colour.minFilter = exact ? NearestFilter : LinearFilter;
    colour.magFilter = colour.minFilter;
    // The graphics card has its copy then.
    colour.onUpdate = () => bitmap.close();
    this.drop();
    this.shown = { frame: rest, colour, depth: null };
    this.atPose = true;
    if (!later) {
      this.fade.to(0, true);
      this.fade.to(1, this.reducedMotion());
    }
    const u = this.uniforms;
    u.colour.value = colour;
    u.sceneFromCamera.value = matrixOf(sceneFromCamera(this.world, frame));
    const half =
      frame.orthoHeightM !== null ? frame.orthoHeightM / 2 : Math.tan(((frame.fovyDeg ?? 60) * Math.PI) / 360);
    u.halfSize.value.set((half * frame.width) / frame.height, half);
    u.perspective.value = frame.orthoHeightM === null ? 1 : 0;
  }

  /** The camera moves, or the frame is no longer wanted: it goes. */
  leave(): void {
    this.atPose = false;
    this.fade.to(0, this.reducedMotion());
  }

  setClip(clip: Box | null): void {
    this.clip = clip;
    if (clip === null) return;
    this.uniforms.clipMin.value.set(...clip.min);
    this.uniforms.clipMax.value.set(...clip.max);
  }

  setDrape(drape: Drape | null): void {
    this.drape = drape;
    this.uniforms.drapeMap.value = drape?.texture ?? null;
    if (drape === null) return;
    this.uniforms.drapeMin.value.copy(drape.min);
    this.uniforms.drapeMax.value.copy(drape.max);
  }

  step(nowMs: number): void {
    this.fade.step(nowMs);
    if (this.fade.gone && this.shown !== null) this.drop();
  }

  /** Over what is drawn already. The scissor of the caller holds. */
  draw(renderer: WebGLRenderer, camera: Camera): void {
    const { shown } = this;
    if (shown === null || this.fade.opacity === 0) return;
    this.uniforms.opacity.value = this.fade.opacity;
    const still = this.atPose;
    const [clip, drape] = [this.clip !== null, this.drape !== null];
    this.quad.visible = still;
    this.grid.visible = !still;
    if (still) {
      if (clip || drape) this.uploadDepth(shown);
      setDefines(this.quad.material, clip, drape);
    } else {
      this.buildGrid(shown);
      setDefines(this.grid.material, clip, drape);
    }
    renderer.render(this.scene, camera);
  }

  /** What was uploaded is lost (the graphics card was reset). */
  clear(): void {
    this.atPose = false;
    this.fade.to(0, true);
    this.drop();
  }

  dispose(): void {
    this.clear();
    for (const mesh of [this.quad, this.grid, this.depthQuad]) {
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
  }

  private drop(): void {
    const { shown } = this;
    if (shown === null) return;
    const image: unknown = shown.colour.image;
    // Also when it was never drawn; closing twice does nothing.
    if (image instanceof ImageBitmap) image.close();
    shown.colour.dispose();
    shown.depth?.dispose();
    this.shown = null;
    this.uniforms.colour.value = null;
    this.uniforms.depth.value = null;
    if (this.gridOf !== null) {
      this.gridOf = null;
      this.grid.geometry.dispose();
      this.grid.geometry = new BufferGeometry();
    }
  }

  private uploadDepth(shown: Shown): void {
    if (shown.depth === null) {
      const { depthWidth, depthHeight, depthM } = shown.frame;
      const there = depthWidth > 0 && depthHeight > 0 && depthM.length >= depthWidth * depthHeight;
      const values = there ? Float32Array.from(depthM, noSurfaceAsZero) : new Float32Array(1);
      shown.depth = new DataTexture(values, there ? depthWidth : 1, there ? depthHeight : 1, RedFormat, FloatType);
      shown.depth.needsUpdate = true;
    }
    this.uniforms.depth.value = shown.depth;
  }

  private buildGrid(shown: Shown): void {
    if (this.gridOf === shown) return;
    this.gridOf = shown;
    const grid = makeDepthGrid(shown.frame);
    this.grid.geometry.dispose();
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(grid.positions, 3));
    geometry.setAttribute("uv", new BufferAttribute(grid.uvs, 2));
    geometry.setIndex(new BufferAttribute(grid.indices, 1));
    this.grid.geometry = geometry;
    this.grid.matrix.copy(this.uniforms.sceneFromCamera.value);
    this.grid.matrixWorldNeedsUpdate = true;
  }
}

function noSurfaceAsZero(z: number): number {
  return Number.isNaN(z) ? 0 : z;
}
