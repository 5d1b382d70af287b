// What panels and tools may ask of the 3-D scene. Coordinates: ENU metres in doubles; positions on the canvas in CSS pixels from its upper left corner.
import type { Vec2, Vec3 } from "../base/vec.js";
import type { CameraPose, Enu, SurfacePoint } from "../state/app_state.js";
import type { SceneThing } from "./thing.js";
import type { Box } from "./world.js";

export interface Ray {
  readonly originEnu: Enu;
  readonly direction: Vec3;
  /** Radians per CSS pixel (perspective), metres per CSS pixel (orthographic); the other is 0. */
  readonly pixelPitch: number;
  readonly pixelWidthM: number;
}

export interface SceneApi {
  /** Canvas that pointer events of tools come from. */
  readonly canvas: HTMLCanvasElement;
  pose(): CameraPose;
  /** Moves there; duration 0 or reduced motion: jumps. Resolves when it has arrived or another move replaced it. */
  flyTo(pose: CameraPose, durationMs?: number): Promise<void>;
  /** Looks at the box from obliquely above, so that it fills the view. */
  frameBox(min: Enu, max: Enu): Promise<void>;
  rayAt(px: Vec2): Ray;
  /** The surface (tiles or terrain, whatever is shown; the clip box counts) under this place; null: nothing. */
  pickSurface(px: Vec2): SurfacePoint | null;
  /** Id of the building whose model is nearest under this place (the clip box counts, the surface does not); null: none. */
  pickBuilding(px: Vec2): number | null;
  /** What a tour places in the scene. Things that are the same objects as in the list before are left as they are. */
  setThings(list: readonly SceneThing[]): void;
  /** Ids; null: none. */
  highlightThings(selected: string | null, hovered: string | null): void;
  /** A marker was clicked or chosen by the keyboard. Returns the function that ends it. */
  onThingChosen(listener: (id: string) => void): () => void;
  /** Id of the label, marker or model that is seen under this place; null: none. */
  pickThing(px: Vec2): string | null;
  /** As pickSurface, but a model in front of the surface counts too: where a click places a thing. */
  pickPlace(px: Vec2): SurfacePoint | null;
  /** Around a thing, ENU; a label or marker is a point. Null: unknown, or a model that is not loaded. */
  boxOfThing(id: string): Box | null;
  /** Ids of the labels and markers that nothing hides. */
  visibleTexts(): readonly string[];
  /** Canvas position of a point; null: behind the camera. */
  project(point: Enu): Vec2 | null;
  /** Asks for a new frame; the scene draws only on change. */
  invalidate(): void;
  /** Resolves when tiles are loaded, textures uploaded and a frame was drawn since the call. */
  whenIdle(): Promise<void>;
  /** Picture of the canvas as it is now (PNG). */
  capture(): Promise<Blob>;
  dispose(): void;
}
