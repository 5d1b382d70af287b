// What the page knows of the tour beside the tour itself: what may be changed, what is open in the panel, what is being placed, what is played.
import type { NamedAsset } from "../tour/edit_assets.js";
import type { PlayerView } from "../tour/player_view.js";

/** What this session may save. */
export interface Rights {
  readonly documents: boolean;
  readonly tour: boolean;
}

/** What the next click on the surface does. */
export type Placing =
  | { readonly kind: "label" | "marker" }
  | { readonly kind: "model"; readonly asset: NamedAsset }
  | { readonly kind: "move"; readonly thing: string }
  /** The point around which a way leads: to the next stop (null), or of a branch. */
  | { readonly kind: "centre"; readonly stop: string; readonly branch: number | null };

export interface TourView {
  /** Why the tour cannot be changed here; null: it can. */
  readonly locked: string | null;
  /** Another window has saved the tour since it was read here: nothing is saved until somebody has decided. */
  readonly conflict: boolean;
  /** What had to be left out, as sentences. */
  readonly missing: readonly string[];
  /** Ids of what is open in the panel. */
  readonly stop: string | null;
  readonly thing: string | null;
  readonly placing: Placing | null;
  /** A file on its way to the project; fraction null: not known. */
  readonly upload: { readonly name: string; readonly fraction: number | null } | null;
}

export const LOADING_TOUR = "The tour is being loaded.";
export const NO_TOUR_RIGHT = "To change the tour, start the viewer with --edit.";

export const CLOSED_TOUR: TourView = {
  locked: LOADING_TOUR,
  conflict: false,
  missing: [],
  stop: null,
  thing: null,
  placing: null,
  upload: null,
};

/** The tour that is being played. The pose is the scene's. */
export interface TourPlay extends Omit<PlayerView, "pose"> {
  /** Ids of the stops that were reached. */
  readonly seen: readonly string[];
}

/** Where the picture of the ground lies: its upper left corner, and the ways from there along its width and height, ENU. */
export interface GroundMap {
  readonly url: string;
  readonly corner: readonly [number, number];
  readonly across: readonly [number, number];
  readonly down: readonly [number, number];
}
