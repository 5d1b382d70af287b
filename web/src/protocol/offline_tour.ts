// The link of an exported tour in the browser: decoders and canvas for offline_link.ts, and answers to what only the engine can do.
import { systemClock } from "../base/clock.js";
import type { PanoramaImage } from "../geo/panorama.js";
import { decodePicture, inflate, type PictureType } from "./browser_decode.js";
import type { Link } from "./link_api.js";
import { NEEDS_ENGINE, OfflineLink, type OfflinePlatform, type StandPoint } from "./offline_link.js";
import type { Bytes, PackedFiles } from "./packed_files.js";
import { StopPictureStore } from "./stop_pictures.js";
import type { StopPictures } from "./tour_manifest.js";

export interface OfflineTourOptions {
  readonly files: PackedFiles;
  readonly stops: readonly StandPoint[];
  readonly pictures: ReadonlyMap<string, StopPictures>;
  /** For the user; the same text comes once. */
  readonly failed: (text: string) => void;
}

export interface OfflineTour extends Link {
  /** Loads the still of this stop before one arrives there. */
  prepare(stop: string): void;
}

/** All that a screen shows: nothing here is rendered. */
const INSTANT_PX = { side: 4096, all: 3840 * 2160 } as const;

export function openOfflineTour({ files, stops, pictures, failed }: OfflineTourOptions): OfflineTour {
  const told = new Set<string>();
  const tell = (text: string): void => {
    if (told.has(text)) return;
    told.add(text);
    failed(text);
  };
  const platform: OfflinePlatform<ImageBitmap> = {
    clock: systemClock,
    decode: (bytes, image) => decodePicture(bytes, typeOf(image)),
    compose: (width, height, under, over) => Promise.resolve(compose(width, height, under, over)),
    pause: () => new Promise((done) => setTimeout(done, 0)),
    failed: tell,
  };
  const store = new StopPictureStore({ sizes: pictures, files, inflate, pixels, failed: tell });
  const core = new OfflineLink(stops, store, platform);
  const unable = () => Promise.reject(new Error(NEEDS_ENGINE));
  return {
    instantPx: INSTANT_PX,
    prepare: (stop) => core.prepare(stop),
    view: (parameters) => core.view(parameters),
    // No photos are exported.
    viewPhoto: () => {
      core.stop();
      return 0;
    },
    stop: () => core.stop(),
    onFrame: (listener) => core.onFrame(listener),
    onEngine: (listener) => core.onEngine(listener),
    onProgress: () => () => {},
    pick: unable,
    photosAt: unable,
    profile: unable,
    volume: unable,
    errorMap: unable,
    trustMap: unable,
    cancel: () => {},
    statistics: () => core.statistics(),
    close: () => core.close(),
  };
}

function typeOf(image: "jpg" | "png"): PictureType {
  return image === "png" ? "image/png" : "image/jpeg";
}

function canvasOf(width: number, height: number): OffscreenCanvasRenderingContext2D {
  // Read back at once: on a graphics card that would wait for it.
  const context = new OffscreenCanvas(width, height).getContext("2d", { alpha: false, willReadFrequently: true });
  if (context === null) throw new Error("this browser offers no 2-D canvas");
  return context;
}

async function pixels(bytes: Bytes, image: "jpg" | "png"): Promise<PanoramaImage> {
  const bitmap = await decodePicture(bytes, typeOf(image));
  try {
    const { width, height } = bitmap;
    const context = canvasOf(width, height);
    context.drawImage(bitmap, 0, 0);
    return { width, height, rgba: context.getImageData(0, 0, width, height).data };
  } finally {
    bitmap.close();
  }
}

const compose: (...words: Parameters<OfflinePlatform<ImageBitmap>["compose"]>) => ImageBitmap = (
  width,
  height,
  under,
  over,
) => {
  const context = canvasOf(width, height);
  if (under !== null) context.putImageData(new ImageData(under, width, height), 0, 0);
  if (over !== null) {
    const { bitmap, place } = over;
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = "high";
    context.drawImage(bitmap, place.left, place.top, place.width, place.height);
  }
  return context.canvas.transferToImageBitmap();
};
