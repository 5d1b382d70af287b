// Stills and panoramas of the stops of an exported tour: loaded when they are wanted, those of the last stops kept. Without the browser: decoders are
// passed in.
import { errorText } from "../base/abort.js";
import type { DepthPicture, PanoramaDepth, PanoramaImage } from "../geo/panorama.js";
import { type Inflate, unpackDepths } from "./frame.js";
import type { Bytes } from "./packed_files.js";
import { hasDepth, type PictureSize, type StillSize, type StopPictures } from "./tour_manifest.js";

export interface Still {
  readonly width: number;
  readonly height: number;
  readonly image: "jpg" | "png";
  /** Not decoded: that takes a moment, and then the picture is given away. */
  readonly bytes: Bytes;
  readonly depth: DepthPicture | null;
}

export interface Panorama {
  readonly image: PanoramaImage;
  readonly depth: PanoramaDepth | null;
}

export interface StopPicturesOptions {
  /** By the ids of the stops. */
  readonly sizes: ReadonlyMap<string, StopPictures>;
  readonly files: { load(name: string): Promise<Bytes>; release(name: string): void };
  readonly inflate: Inflate;
  readonly pixels: (bytes: Bytes, image: "jpg" | "png") => Promise<PanoramaImage>;
  /** For the user; once for each picture. */
  readonly failed: (text: string) => void;
}

const KEPT_STILLS = 6;
/** 40 MB each at 4096 pixels. */
const KEPT_PANORAMAS = 2;

export class StopPictureStore {
  private readonly options: StopPicturesOptions;
  private readonly stills = new Kept<Still>(KEPT_STILLS);
  private readonly panoramas = new Kept<Panorama>(KEPT_PANORAMAS);
  private readonly lost = new Set<string>();

  constructor(options: StopPicturesOptions) {
    this.options = options;
  }

  hasStill(stop: string): boolean {
    return (this.options.sizes.get(stop)?.still ?? null) !== null && !this.lost.has(`stops/${stop}/still`);
  }

  hasPanorama(stop: string): boolean {
    return (this.options.sizes.get(stop)?.panorama ?? null) !== null && !this.lost.has(`stops/${stop}/panorama`);
  }

  /** Its size, without loading it. */
  stillSize(stop: string): StillSize | null {
    return this.hasStill(stop) ? (this.options.sizes.get(stop)?.still ?? null) : null;
  }

  /** Null: there is none, or it could not be loaded. */
  still(stop: string): Promise<Still | null> {
    const size = this.stillSize(stop);
    if (size === null) return Promise.resolve(null);
    return this.stills.get(stop, () => this.guard(`stops/${stop}/still`, (path) => this.loadStill(path, size)));
  }

  panorama(stop: string): Promise<Panorama | null> {
    const size = this.hasPanorama(stop) ? (this.options.sizes.get(stop)?.panorama ?? null) : null;
    if (size === null) return Promise.resolve(null);
    return this.panoramas.get(stop, () =>
      this.guard(`stops/${stop}/panorama`, (path) => this.loadPanorama(path, size)),
    );
  }

  private async guard<T>(path: string, load: (path: string) => Promise<T>): Promise<T | null> {
    try {
      return await load(path);
    } catch (error) {
      this.lost.add(path);
      this.options.failed(`A picture of the tour is not shown: ${errorText(error)}.`);
      return null;
    }
  }

  private async loadStill(path: string, size: StillSize): Promise<Still> {
    const [bytes, depthM] = await Promise.all([this.take(`${path}.${size.image}`), this.loadDepths(path, size)]);
    const depth = depthM === null ? null : { width: size.depthWidth, height: size.depthHeight, depthM };
    return { width: size.width, height: size.height, image: size.image, bytes, depth };
  }

  private async loadPanorama(path: string, size: PictureSize): Promise<Panorama> {
    const [bytes, distanceM] = await Promise.all([this.take(`${path}.jpg`), this.loadDepths(path, size)]);
    const image = await this.options.pixels(bytes, "jpg");
    if (image.width !== size.width || image.height !== size.height) {
      throw new Error(`${path}.jpg has ${image.width} x ${image.height} pixels, not ${size.width} x ${size.height}`);
    }
    const depth = distanceM === null ? null : { width: size.depthWidth, height: size.depthHeight, distanceM };
    return { image, depth };
  }

  private async loadDepths(path: string, size: PictureSize): Promise<Float32Array | null> {
    if (!hasDepth(size)) return null;
    const packed = await this.take(`${path}.depth`);
    const { nearM, farM, depthWidth, depthHeight } = size;
    try {
      const code = { count: depthWidth * depthHeight, nearM, farM, inverse: true };
      return await unpackDepths(packed, code, this.options.inflate);
    } catch (error) {
      throw new Error(`${path}.depth is damaged, ${errorText(error)}: export the tour again`);
    }
  }

  private async take(name: string): Promise<Bytes> {
    const { files } = this.options;
    const bytes = await files.load(name);
    files.release(name);
    return bytes;
  }
}

/** The last few that were asked for. */
class Kept<T> {
  private readonly most: number;
  private readonly entries = new Map<string, Promise<T | null>>();

  constructor(most: number) {
    this.most = most;
  }

  get(key: string, make: () => Promise<T | null>): Promise<T | null> {
    const entry = this.entries.get(key) ?? make();
    this.entries.delete(key);
    this.entries.set(key, entry);
    for (const oldest of this.entries.keys()) {
      if (this.entries.size <= this.most) break;
      this.entries.delete(oldest);
    }
    return entry;
  }
}
