// The textured mesh as 3D Tiles: streamed by distance, with a limit on memory.
import { DEFAULT_LRU_CACHE, LRUCache, type Tile } from "3d-tiles-renderer/core";
import { TilesRenderer } from "3d-tiles-renderer/three";
import {
  BufferAttribute,
  BufferGeometry,
  type Camera,
  LinearMipmapLinearFilter,
  type Material,
  Mesh,
  MeshBasicMaterial,
  NoColorSpace,
  type Object3D,
  type Texture,
} from "three";
import { asObject, parseJson } from "../base/check.js";
import { makeCoarse } from "./coarse_mesh.js";
import type { LoadBytes } from "./load_bytes.js";
import type { Quality } from "./quality.js";
import type { Surface, SurfaceEvents } from "./surface.js";
import { matrixOf, type SurfaceStyle } from "./surface_style.js";
import type { Size } from "./view_math.js";

const MOST_BYTES = 384 * 2 ** 20;
const KEPT_BYTES = 256 * 2 ** 20;
/** Larger than any error: what has it is always replaced by its parts. */
const ENDLESS_ERROR_M = 1e12;
/** Of a tile's error, which covers up to 16 pixels when the tile is near: cells of 2 pixels. */
const CELL_OF_ERROR = 2 / 16;

function textureOfMaterial(material: Material | Material[]): Texture | null {
  const first = Array.isArray(material) ? material[0] : material;
  return first !== undefined && "map" in first && isTexture(first.map) ? first.map : null;
}

function isTexture(value: unknown): value is Texture {
  return typeof value === "object" && value !== null && "isTexture" in value;
}

export interface TilesOptions {
  readonly url: string;
  /** 16 numbers row by row, from the frame that the tileset's root transform leads to. */
  readonly sceneFromTiles: readonly number[];
  readonly style: SurfaceStyle;
  readonly software: boolean;
  readonly loadBytes: LoadBytes;
}

export class TilesLayer implements Surface {
  private readonly tiles: TilesRenderer;
  private readonly abort = new AbortController();
  private readonly style: SurfaceStyle;
  private readonly events: SurfaceEvents;
  private readonly software: boolean;
  private camera: Camera | null = null;
  private root: "waiting" | "ready" | "failed" = "waiting";
  private updatesOfRoot = 0;
  private loading = false;
  private failures = 0;
  /** Full geometry of each mesh, and the coarse one: undefined, not made yet; null, there is none. */
  private readonly shapes = new WeakMap<
    Mesh,
    { readonly fine: BufferGeometry; readonly cellM: number; coarse: BufferGeometry | null | undefined }
  >();
  private over = false;

  constructor({ url, sceneFromTiles, style, software, loadBytes }: TilesOptions, events: SurfaceEvents) {
    this.style = style;
    this.software = software;
    this.events = events;
    const tiles = new TilesRenderer(url);
    this.tiles = tiles;
    // Not the cache that all tilesets share.
    tiles.lruCache = new LRUCache();
    tiles.lruCache.unloadPriorityCallback = DEFAULT_LRU_CACHE.unloadPriorityCallback;
    tiles.lruCache.maxBytesSize = MOST_BYTES;
    tiles.lruCache.minBytesSize = KEPT_BYTES;
    tiles.fetchOptions = { signal: this.abort.signal };
    tiles.registerPlugin({
      name: "skyquilt",
      fetchData: (wanted: string, { signal }: { readonly signal: AbortSignal }) => {
        const bytes = loadBytes(wanted, signal);
        return wanted === url ? bytes.then(readTileset) : bytes;
      },
      processTileModel: (scene: Object3D, tile: Tile) => this.dress(scene, tile),
    });
    tiles.group.matrixAutoUpdate = false;
    tiles.group.matrix.copy(matrixOf(sceneFromTiles));
    tiles.group.matrixWorldNeedsUpdate = true;
    tiles.group.updateMatrixWorld(true);
    tiles.addEventListener("load-root-tileset", () => {
      this.root = "ready";
      const root = tiles.root;
      // A root without content would be shown, as nothing, when it is far away.
      if (root !== null && root.content === undefined) root.geometricError = ENDLESS_ERROR_M;
      this.changed();
    });
    tiles.addEventListener("needs-update", () => this.changed());
    tiles.addEventListener("tiles-load-start", () => {
      this.loading = true;
    });
    tiles.addEventListener("tiles-load-end", () => {
      this.loading = false;
      this.changed();
    });
    tiles.addEventListener("tile-visibility-change", () => this.changed());
    // A tile whose loading was given up never comes here, so nothing must hold it before.
    tiles.addEventListener("load-model", ({ scene }) => {
      scene.traverse((object) => {
        if (object instanceof Mesh && object.material instanceof MeshBasicMaterial) this.style.adopt(object.material);
      });
    });
    tiles.addEventListener("dispose-model", ({ scene }) => this.forget(scene));
    tiles.addEventListener("load-error", ({ tile, error }) => this.onError(tile, error));
  }

  get object(): Object3D {
    return this.tiles.group;
  }

  get busy(): boolean {
    return this.root === "waiting" || (this.root === "ready" && (this.loading || this.updatesOfRoot < 2));
  }

  update(camera: Camera, size: Size, quality: Quality): void {
    const { tiles } = this;
    if (this.camera !== camera) {
      if (this.camera !== null) tiles.deleteCamera(this.camera);
      tiles.setCamera(camera);
      this.camera = camera;
    }
    tiles.setResolution(camera, Math.max(1, size[0]), Math.max(1, size[1]));
    tiles.errorTarget = quality.errorTarget;
    tiles.update();
    this.chooseShapes(quality.coarse);
    if (this.root !== "ready" || this.updatesOfRoot >= 2) return;
    this.updatesOfRoot += 1;
    this.changed();
  }

  eachMesh(visit: (mesh: Mesh, geometry: BufferGeometry) => void): void {
    // Children of the group are the tiles that are shown.
    this.tiles.group.traverse((object) => {
      if (object instanceof Mesh) visit(object, this.shapes.get(object)?.fine ?? object.geometry);
    });
  }

  dispose(): void {
    this.over = true;
    this.abort.abort();
    this.tiles.dispose();
  }

  /** Makes at most one coarse mesh a frame, which takes about as long as a frame. */
  private chooseShapes(coarse: boolean): void {
    let made = false;
    this.eachMesh((mesh) => {
      const shape = this.shapes.get(mesh);
      if (shape === undefined) return;
      if (coarse && shape.coarse === undefined && !made) {
        shape.coarse = coarseOf(shape.fine, shape.cellM);
        made = true;
      }
      mesh.geometry = coarse ? (shape.coarse ?? shape.fine) : shape.fine;
    });
  }

  private changed(): void {
    if (!this.over) this.events.changed();
  }

  /** Runs before the tile is registered, so that its disposal reaches our materials, and through their `map` the textures. */
  private dress(scene: Object3D, tile: Tile): void {
    scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      const given: Material | Material[] = object.material;
      const map = textureOfMaterial(given);
      if (map !== null) {
        // Display values pass through unchanged.
        map.colorSpace = NoColorSpace;
        if (!this.software) {
          map.generateMipmaps = true;
          map.minFilter = LinearMipmapLinearFilter;
          map.anisotropy = 4;
        }
        map.needsUpdate = true;
      }
      object.material = this.style.makeMaterial(map);
      for (const material of Array.isArray(given) ? given : [given]) material.dispose();
      // Without light they are only bytes.
      object.geometry.deleteAttribute("normal");
      // Tiles without finer ones are seen from anywhere near, so they keep their shape.
      this.shapes.set(object, { fine: object.geometry, cellM: tile.geometricError * CELL_OF_ERROR, coarse: undefined });
    });
  }

  private forget(scene: Object3D): void {
    scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      const shape = this.shapes.get(object);
      shape?.coarse?.dispose();
      this.shapes.delete(object);
    });
  }

  private onError(tile: Tile | null, error: Error): void {
    if (this.over) return;
    if (tile === null) {
      this.root = "failed";
      this.events.failed(
        `The surface cannot be shown: ${error.message}. Reload the page; if that does not help, run \`skyquilt surface\` again.`,
      );
    } else {
      this.failures += 1;
      if (this.failures === 1)
        this.events.failed(
          `A part of the surface could not be loaded (${error.message}). Reload the page to try again.`,
        );
    }
    this.changed();
  }
}

/** The library warns of version 1.1 on the console. What is new in it, our tilesets do not use. */
function readTileset(bytes: ArrayBuffer): unknown {
  const tileset = asObject(parseJson(new TextDecoder().decode(bytes), "tileset.json"), "tileset.json");
  return { ...tileset, asset: { ...asObject(tileset.asset, "tileset.json.asset"), version: "1.0" } };
}

function coarseOf(fine: BufferGeometry, cellM: number): BufferGeometry | null {
  const [position, uv, index] = [fine.getAttribute("position"), fine.getAttribute("uv"), fine.index];
  if (position === undefined || uv === undefined || index === null || position.itemSize !== 3 || uv.itemSize !== 2)
    return null;
  const [positions, uvs, indices] = [position.array, uv.array, index.array];
  if (!(positions instanceof Float32Array) || !(uvs instanceof Float32Array)) return null;
  if (!(indices instanceof Uint16Array || indices instanceof Uint32Array)) return null;
  const coarse = makeCoarse({ positions, uvs, indices }, cellM);
  if (coarse === null || coarse.indices === null) return null;
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(coarse.positions, 3));
  geometry.setAttribute("uv", new BufferAttribute(coarse.uvs, 2));
  geometry.setIndex(new BufferAttribute(coarse.indices, 1));
  return geometry;
}
