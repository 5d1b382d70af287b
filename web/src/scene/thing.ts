// What a tour places in the scene: models, labels and markers. Values never change; another list replaces the one before.
import type { Enu } from "../state/app_state.js";

export interface ModelThing {
  readonly kind: "model";
  readonly id: string;
  /** Where the origin of the file is. */
  readonly at: Enu;
  /** Clockwise from north, seen from above. At 0 the file's x is east and its -z north (y is up), as in GLBs that skyquilt writes. */
  readonly yawDeg: number;
  /** 1: the file's unit is a metre. */
  readonly scale: number;
  /** For the user. */
  readonly name: string;
  /** Of a self-contained GLB; what `LoadBytes` gets. */
  readonly url: string;
}

/** A text at a place; a marker is one that can be chosen. */
export interface TextThing {
  readonly kind: "label" | "marker";
  readonly id: string;
  readonly at: Enu;
  readonly text: string;
}

export type SceneThing = ModelThing | TextThing;
