// The surface model under the orthophoto, for projects without a textured mesh.
import {
  BufferAttribute,
  BufferGeometry,
  type Camera,
  Group,
  Mesh,
  type MeshBasicMaterial,
  type Object3D,
  type Texture,
} from "three";
import type { ProjectBase } from "../state/project.js";
import type { LoadBytes } from "./load_bytes.js";
import type { Quality } from "./quality.js";
import type { Surface, SurfaceEvents } from "./surface.js";
import { matrixOf, type SurfaceStyle, textureOf } from "./surface_style.js";
import { makePatch, parseTerrain, patchesOf, shade, stepFor, type TerrainGrid } from "./terrain_grid.js";
import type { Size } from "./view_math.js";
import { multiply, translation } from "./world.js";

const MOST_TRIANGLES = 1_500_000;
const MOST_TRIANGLES_SOFTWARE = 150_000;

export interface TerrainOptions {
  readonly style: SurfaceStyle;
  readonly software: boolean;
  readonly maxTexturePx: number;
  /** From the project's own ENU, 16 numbers row by row. */
  readonly sceneFromOwn: readonly number[];
  readonly loadBytes: LoadBytes;
}

export class TerrainLayer implements Surface {
  readonly object: Object3D = new Group();
  private readonly options: TerrainOptions;
  private readonly events: SurfaceEvents;
  private readonly abort = new AbortController();
  private readonly meshes: Mesh<BufferGeometry, MeshBasicMaterial>[] = [];
  private texture: Texture | null = null;
  private loading = true;

  constructor(project: ProjectBase & { readonly terrain: string }, options: TerrainOptions, events: SurfaceEvents) {
    this.options = options;
    this.events = events;
    void this.start(project.terrain, project.orthophoto);
  }

  get busy(): boolean {
    return this.loading;
  }

  update(_camera: Camera, _size: Size, _quality: Quality): void {}

  eachMesh(visit: (mesh: Mesh, geometry: BufferGeometry) => void): void {
    for (const mesh of this.meshes) visit(mesh, mesh.geometry);
  }

  dispose(): void {
    this.abort.abort();
    for (const mesh of this.meshes) {
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
    this.meshes.length = 0;
    this.dropTexture();
    this.object.removeFromParent();
  }

  private dropTexture(): void {
    const image: unknown = this.texture?.image;
    if (image instanceof ImageBitmap) image.close();
    this.texture?.dispose();
    this.texture = null;
  }

  private async start(terrain: string, orthophoto: string | null): Promise<void> {
    const { signal } = this.abort;
    try {
      // Shapes and picture at the same time; a missing picture leaves shades of grey.
      const picture = orthophoto === null ? Promise.resolve(null) : this.loadPicture(orthophoto);
      const grid = parseTerrain(await this.options.loadBytes(terrain, signal));
      this.texture = await picture;
      if (signal.aborted) this.dropTexture();
      else this.build(grid);
    } catch (error) {
      if (!signal.aborted)
        this.events.failed(
          `The surface model cannot be shown: ${error instanceof Error ? error.message : String(error)}`,
        );
    } finally {
      this.loading = false;
      if (!signal.aborted) this.events.changed();
    }
  }

  private async loadPicture(url: string): Promise<Texture | null> {
    try {
      const bytes = await this.options.loadBytes(url, this.abort.signal);
      const blob = new Blob([bytes], { type: "image/jpeg" });
      const options: ImageBitmapOptions = { colorSpaceConversion: "none", premultiplyAlpha: "none" };
      let bitmap = await createImageBitmap(blob, options);
      const most = this.options.maxTexturePx;
      if (bitmap.width > most || bitmap.height > most) {
        const factor = most / Math.max(bitmap.width, bitmap.height);
        const resizeWidth = Math.max(1, Math.floor(bitmap.width * factor));
        const resizeHeight = Math.max(1, Math.floor(bitmap.height * factor));
        bitmap.close();
        bitmap = await createImageBitmap(blob, { ...options, resizeWidth, resizeHeight, resizeQuality: "high" });
      }
      return textureOf(bitmap);
    } catch (error) {
      if (!this.abort.signal.aborted)
        this.events.failed(`The orthophoto cannot be shown: ${error instanceof Error ? error.message : String(error)}`);
      return null;
    }
  }

  private build(grid: TerrainGrid): void {
    const { style, software, sceneFromOwn } = this.options;
    this.object.matrixAutoUpdate = false;
    this.object.matrix.copy(matrixOf(multiply(sceneFromOwn, translation(grid.anchor))));
    this.object.matrixWorldNeedsUpdate = true;
    const step = stepFor(grid, software ? MOST_TRIANGLES_SOFTWARE : MOST_TRIANGLES);
    for (const { from, to } of patchesOf(grid, step)) {
      const patch = makePatch(grid, from, to, step);
      if (patch === null) continue;
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(patch.positions, 3));
      geometry.setIndex(new BufferAttribute(patch.indices, 1));
      if (this.texture === null) geometry.setAttribute("color", new BufferAttribute(shade(patch.normals), 3));
      else geometry.setAttribute("uv", new BufferAttribute(patch.uvs, 2));
      geometry.computeBoundingBox();
      geometry.computeBoundingSphere();
      const material = style.makeMaterial(this.texture, this.texture === null);
      style.adopt(material);
      const mesh = new Mesh(geometry, material);
      this.meshes.push(mesh);
      this.object.add(mesh);
    }
  }
}
