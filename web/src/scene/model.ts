// A model as it is held in memory: shared by all things that show the same file.
import type { Object3D } from "three";
import type { Box } from "./world.js";

export interface Model {
  /** Never changed: copies of it are shown. In the file's axes, y up. */
  readonly object: Object3D;
  readonly box: Box;
  /** Frees what its copies share. */
  dispose(): void;
}

/** A file that was read and found good, but needs its memory still. */
export interface PlannedModel {
  readonly bytes: number;
  /** Rejects with an Error for the user. */
  make(): Promise<Model>;
}

/** Throws an Error for the user. */
export type ReadModel = (bytes: ArrayBuffer) => PlannedModel;
