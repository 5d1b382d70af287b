// The engine's part in an exported tour, played by the pictures of its stops: a view from where a stop stands is answered with the stop's still when it
// looks the same way, else with a picture from its panorama; from elsewhere nothing comes, and the mesh is seen. Without the browser, so that Node can
// test it; offline_tour.ts joins it to the page.
import { errorText } from "../base/abort.js";
import type { Clock } from "../base/clock.js";
import { Emitter } from "../base/emitter.js";
import type { Quat, Vec3 } from "../base/vec.js";
import { angleBetweenRad, norm, sub } from "../base/vec_math.js";
import { type DepthPicture, drawDepth, drawRows, focalPx, type PerspectiveView } from "../geo/panorama.js";
import { fills, reframedDepth, reframing } from "../geo/reframe.js";
import type { DecodedFrame, LinkStatus } from "./link_platform.js";
import type { ViewFields } from "./messages.js";
import type { Bytes } from "./packed_files.js";
import type { Panorama, Still, StopPictureStore } from "./stop_pictures.js";

export interface StandPoint {
  readonly id: string;
  readonly eyeEnu: Vec3;
  readonly rotation: Quat;
  readonly fovyDeg: number;
}

export interface PicturePlace {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

export interface OfflinePlatform<Bitmap> {
  readonly clock: Clock;
  decode(bytes: Bytes, image: "jpg" | "png"): Promise<Bitmap>;
  /** A picture of this size: `under` (red, green, blue, alpha; null: nothing), and `over` scaled to its place, which may reach beyond the rim. */
  compose(
    width: number,
    height: number,
    under: Uint8ClampedArray<ArrayBuffer> | null,
    over: { readonly bitmap: Bitmap; readonly place: PicturePlace } | null,
  ): Promise<Bitmap>;
  /** Lets the page react meanwhile. */
  pause(): Promise<void>;
  /** For the user. */
  failed(text: string): void;
}

export const NEEDS_ENGINE = "this needs the project and the program: open it with `skyquilt view`";

const SAME_PLACE_M = 1e-3;
/** A tenth of a pixel of a usual still. */
const SAME_TURN_RAD = 1e-4;
/** Finer than this times the panorama's own pixels there is nothing to see in it. */
const FINER = 1.25;
/** Longer work would be felt. */
const SLICE_MS = 12;
const SLICE_ROWS = 8;
const STATUS: LinkStatus = {
  connected: true,
  ready: true,
  reason: "",
  revision: 0,
  exposure: "",
  clients: 1,
  ranks: 1,
};

interface Answer extends PerspectiveView {
  readonly seq: number;
  readonly eyeEnu: Vec3;
}

export class OfflineLink<Bitmap extends { readonly width: number; readonly height: number; close(): void }> {
  private readonly stands: readonly StandPoint[];
  private readonly pictures: StopPictureStore;
  private readonly platform: OfflinePlatform<Bitmap>;
  private readonly frames = new Emitter<[DecodedFrame<Bitmap>]>();
  private seq = 0;
  /** Of the view that is wanted; -1: none. */
  private wanted = -1;
  private dropped = 0;

  constructor(stands: readonly StandPoint[], pictures: StopPictureStore, platform: OfflinePlatform<Bitmap>) {
    this.stands = stands;
    this.pictures = pictures;
    this.platform = platform;
  }

  view(fields: ViewFields): number {
    this.seq += 1;
    const seq = this.seq;
    this.wanted = seq;
    const { eyeEnu, rotation, fovyDeg, w, h } = fields;
    if (fovyDeg === null || fields.project !== "main") return seq;
    const view: Answer = { seq, eyeEnu, rotation, fovyDeg, width: w, height: h };
    this.answer(view).catch((error: unknown) =>
      this.platform.failed(`A picture of the tour is not shown: ${errorText(error)}.`),
    );
    return seq;
  }

  stop(): void {
    this.wanted = -1;
  }

  onFrame(listener: (frame: DecodedFrame<Bitmap>) => void): () => void {
    return this.frames.on(listener);
  }

  onEngine(listener: (status: LinkStatus) => void): () => void {
    let ended = false;
    // Not before the caller has what this returns.
    void Promise.resolve().then(() => {
      if (!ended) listener(STATUS);
    });
    return () => {
      ended = true;
    };
  }

  /** Loads the still of a stop before one arrives there; its panorama comes after the still is shown. */
  prepare(stop: string): void {
    void this.pictures.still(stop);
  }

  statistics(): { readonly badMessages: number; readonly droppedFrames: number; readonly reconnects: number } {
    return { badMessages: 0, droppedFrames: this.dropped, reconnects: 0 };
  }

  close(): void {
    this.stop();
    this.frames.clear();
  }

  private async answer(view: Answer): Promise<void> {
    const here = this.stands
      .filter(({ eyeEnu }) => norm(sub(eyeEnu, view.eyeEnu)) <= SAME_PLACE_M)
      .sort((a, b) => angleBetweenRad(a.rotation, view.rotation) - angleBetweenRad(b.rotation, view.rotation));
    const own = here.find(
      ({ id, rotation }) => this.pictures.hasStill(id) && angleBetweenRad(rotation, view.rotation) <= SAME_TURN_RAD,
    );
    const still = own === undefined ? null : await this.pictures.still(own.id);
    const turned = here.find(({ id }) => this.pictures.hasPanorama(id));
    const frameOf = own === undefined || still === null ? null : { ...still, fovyDeg: own.fovyDeg };
    if (frameOf !== null && fills(frameOf, view)) {
      await this.showStill(view, frameOf, turned?.id ?? null);
      return;
    }
    const panorama = turned === undefined || !this.isWanted(view) ? null : await this.pictures.panorama(turned.id);
    if (panorama !== null) await this.showPanorama(view, panorama, frameOf);
  }

  /** Its own depths come with it; those of the panorama, when the still has none, after it. */
  private async showStill(
    view: Answer,
    still: Still & { readonly fovyDeg: number },
    turned: string | null,
  ): Promise<void> {
    const shown = withinDetail(view, focalPx(still), still);
    const borrows = still.depth === null && turned !== null;
    const depth = still.depth === null ? null : reframedDepth(still, still.depth, shown);
    if (!this.isWanted(view)) return;
    this.send(view, shown, await this.reframed(still, shown, null), depth, 0, borrows ? 2 : 1);
    if (turned === null) return;
    // One may turn the view next.
    const panorama = await this.pictures.panorama(turned);
    if (!borrows || !this.isWanted(view)) return;
    const { depth: all } = panorama ?? { depth: null };
    this.send(view, shown, await this.reframed(still, shown, null), all === null ? null : drawDepth(all, shown), 1, 2);
  }

  private async showPanorama(
    view: Answer,
    panorama: Panorama,
    still: (Still & { readonly fovyDeg: number }) | null,
  ): Promise<void> {
    const { image, depth: all } = panorama;
    const detailPx = still === null ? (FINER * image.width) / (2 * Math.PI) : focalPx(still);
    const shown = withinDetail(view, detailPx, still);
    const rgba = new Uint8ClampedArray(4 * shown.width * shown.height);
    const { clock } = this.platform;
    let beganMs = clock.nowMs();
    for (let row = 0; row < shown.height; row += SLICE_ROWS) {
      drawRows(image, shown, rgba, row, Math.min(shown.height, row + SLICE_ROWS));
      if (clock.nowMs() - beganMs < SLICE_MS) continue;
      await this.platform.pause();
      if (!this.isWanted(view)) return;
      beganMs = clock.nowMs();
    }
    const depth = all === null ? null : drawDepth(all, shown);
    if (depth !== null && still !== null && still.depth !== null)
      layOver(depth, reframedDepth(still, still.depth, shown));
    const bitmap =
      still === null
        ? await this.platform.compose(shown.width, shown.height, rgba, null)
        : await this.reframed(still, shown, rgba);
    this.send(view, shown, bitmap, depth, 0, 1);
  }

  private async reframed(
    still: Still & { readonly fovyDeg: number },
    view: PerspectiveView,
    under: Uint8ClampedArray<ArrayBuffer> | null,
  ): Promise<Bitmap> {
    const bitmap = await this.platform.decode(still.bytes, still.image);
    const { left, top, scale } = reframing(still, view);
    const sameSize = view.width === bitmap.width && view.height === bitmap.height;
    // Within half a pixel at the rim: then each pixel is left as it is.
    if (sameSize && Math.abs(left) < 0.5 && Math.abs(top) < 0.5) return bitmap;
    try {
      const place = {
        left: -left / scale,
        top: -top / scale,
        width: still.width / scale,
        height: still.height / scale,
      };
      return await this.platform.compose(view.width, view.height, under, { bitmap, place });
    } finally {
      bitmap.close();
    }
  }

  private isWanted({ seq }: Answer): boolean {
    return this.wanted === seq;
  }

  private send(
    view: Answer,
    { width, height }: PerspectiveView,
    bitmap: Bitmap,
    depth: DepthPicture | null,
    pass: number,
    passes: number,
  ): void {
    if (!this.isWanted(view)) {
      this.dropped += 1;
      bitmap.close();
      return;
    }
    const { seq, eyeEnu, rotation, fovyDeg } = view;
    this.frames.emit({
      seq,
      revision: STATUS.revision,
      pass,
      passes,
      project: "main",
      isPhoto: false,
      width,
      height,
      eyeEnu,
      rotation,
      fovyDeg,
      orthoHeightM: null,
      bitmap,
      depthWidth: depth?.width ?? 0,
      depthHeight: depth?.height ?? 0,
      depthM: depth?.depthM ?? new Float32Array(0),
      ...rangeOf(depth),
    });
  }
}

/**
 * The view in no more pixels than the picture plane of a source at this distance has; the graphics card enlarges it as well. `still`: what is cut out
 * of it lies on whole pixels then, else all of it would be blurred.
 */
function withinDetail(
  view: PerspectiveView,
  sourceFocalPx: number,
  still: Pick<Still, "width" | "height"> | null,
): PerspectiveView {
  const factor = sourceFocalPx / focalPx(view);
  const { rotation, fovyDeg, width, height } = view;
  if (!(factor < 0.999)) return { rotation, fovyDeg, width, height };
  const side = (px: number, odd: number) => Math.max(2, odd + 2 * Math.round((px * factor - odd) / 2));
  const [oddWidth, oddHeight] = still === null ? [0, 0] : [still.width % 2, still.height % 2];
  return { rotation, fovyDeg, width: side(width, oddWidth), height: side(height, oddHeight) };
}

/** The depths of `upper` where it has any. */
function layOver(lower: DepthPicture, upper: DepthPicture): void {
  for (const [i, z] of upper.depthM.entries()) if (!Number.isNaN(z)) lower.depthM[i] = z;
}

function rangeOf(depth: DepthPicture | null): { readonly nearM: number; readonly farM: number } {
  let [nearM, farM] = [Number.POSITIVE_INFINITY, 0];
  for (const z of depth?.depthM ?? []) {
    if (z < nearM) nearM = z;
    if (z > farM) farM = z;
  }
  return farM > 0 ? { nearM, farM } : { nearM: 0, farM: 0 };
}
