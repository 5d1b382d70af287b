// The connection to the engine, as scene, tools and panels see it.
import type { Quat, Vec2, Vec3 } from "../base/vec.js";
import type { DrapedMap, EngineStatus, Enu, ErrorMap, PhotoSight, Survey, VolumeBase } from "../state/app_state.js";
import type { PickedText as Picked, ProfileText as ProfileReply, VolumeText as VolumeReply } from "./replies.js";

export type Which = Survey;

export interface ViewParameters {
  readonly project: Which;
  readonly eyeEnu: Enu;
  readonly rotation: Quat;
  /** Exactly one of the two is not null. */
  readonly fovyDeg: number | null;
  readonly orthoHeightM: number | null;
  readonly w: number;
  readonly h: number;
}

/** A decoded frame: header, colour and depth as one value. Whoever receives it closes the bitmap. */
export interface ExactFrame {
  readonly seq: number;
  readonly revision: number;
  readonly pass: number;
  readonly passes: number;
  readonly project: Which;
  readonly isPhoto: boolean;
  readonly width: number;
  readonly height: number;
  readonly eyeEnu: Enu;
  readonly rotation: Quat;
  readonly fovyDeg: number | null;
  readonly orthoHeightM: number | null;
  readonly bitmap: ImageBitmap;
  readonly depthWidth: number;
  readonly depthHeight: number;
  /** z along the optical axis in metres, NaN: no surface. Depth pixel (i, j) belongs to colour pixel (2i, 2j). */
  readonly depthM: Float32Array;
  readonly nearM: number;
  readonly farM: number;
}

export type { Picked, ProfileReply, VolumeReply };

/** Requests reject with an Error whose message is for the user. A newer pick replaces a waiting one, which then rejects with an AbortError. */
export interface Link {
  /** Frames of up to this size come at once. Without it they are rendered, which takes seconds when they are large. */
  readonly instantPx?: { readonly side: number; readonly all: number };
  /** The camera rests here. Returns the seq of the frames that will come. */
  view(parameters: ViewParameters): number;
  viewPhoto(photo: number, w: number): number;
  /** The camera moves: what is being rendered is no longer wanted. */
  stop(): void;
  onFrame(listener: (frame: ExactFrame) => void): () => void;
  onEngine(listener: (status: Omit<EngineStatus, "pass" | "passes">) => void): () => void;
  onProgress(listener: (id: number, what: string, fraction: number | null, done: boolean) => void): () => void;
  pick(
    ray: {
      readonly originEnu: Enu;
      readonly direction: Vec3;
      readonly pixelPitch: number;
      readonly pixelWidthM: number;
    },
    project?: Which,
  ): Promise<Picked>;
  photosAt(point: Enu): Promise<{ readonly checked: boolean; readonly photos: readonly PhotoSight[] }>;
  profile(from: Vec2, to: Vec2, samples: number, project?: Which): Promise<ProfileReply>;
  volume(polygon: readonly Vec2[], base: VolumeBase, baseHeightM: number, project?: Which): Promise<VolumeReply>;
  errorMap(): Promise<ErrorMap>;
  trustMap(): Promise<DrapedMap>;
  /** Ends the request of this id (as onProgress names it); it rejects with an AbortError. */
  cancel(id: number): void;
  /** Counts for tests and the status line. */
  statistics(): { readonly badMessages: number; readonly droppedFrames: number; readonly reconnects: number };
  close(): void;
}
