// The state of the application that panels, tools and scene share: one immutable value in one store. The camera is not in it: it moves 60 times a
// second, and read-outs are told of it 10 times a second (`readout`).
import type { Quat, Vec2, Vec3 } from "../base/vec.js";
import type { Estimate } from "../geo/measure.js";
import type { Tour } from "../tour/types.js";
import type { BuildingsState } from "./buildings.js";
import type { GroundMap, Rights, TourPlay, TourView } from "./tour_state.js";

/** ENU of the main project, metres, double. */
export type Enu = Vec3;

/** A camera at rest or a key frame. Rotation is cam_from_enu with COLMAP's axes (x right, y down, z ahead). */
export interface CameraPose {
  readonly eyeEnu: Enu;
  readonly rotation: Quat;
  readonly fovyDeg: number;
  /** Height of the picture in metres; null: perspective. */
  readonly orthoHeightM: number | null;
}

/** A point on the surface that a person chose. `source` says whether the mesh or the exact field gave it. */
export interface SurfacePoint {
  readonly enu: Enu;
  /** Unit direction of the ray that found it, in ENU. */
  readonly direction: Vec3;
  /** One standard deviation along that ray, metres; null: unknown (mesh). */
  readonly spreadM: number | null;
  /** Size of a pixel there, metres. */
  readonly pixelM: number;
  readonly source: "mesh" | "field";
}

/** The project that is open, or the earlier one that it is compared with. */
export type Survey = "main" | "before";
export type VolumeBase = "plane" | "lowest" | "height" | "before";

interface MeasurementBase {
  readonly id: string;
  readonly name: string;
  readonly points: readonly SurfacePoint[];
}
export interface PointMeasurement extends MeasurementBase {
  readonly kind: "point";
}
export interface DistanceMeasurement extends MeasurementBase {
  readonly kind: "distance";
  /** Along the points in order: slope, plan and height difference of the ends. */
  readonly result: { readonly slope: Estimate; readonly plan: Estimate; readonly rise: Estimate };
}
export interface ProfileMeasurement extends MeasurementBase {
  readonly kind: "profile";
  readonly survey: Survey;
  readonly lengthM: number;
  readonly heightsM: readonly (number | null)[];
  readonly spreadsM: readonly (number | null)[];
}
export interface AreaMeasurement extends MeasurementBase {
  readonly kind: "area";
  readonly result: { readonly plan: Estimate; readonly sloped: Estimate; readonly perimeter: Estimate };
}
export interface VolumeMeasurement extends MeasurementBase {
  readonly kind: "volume";
  /** On whose surface the outline was drawn. */
  readonly survey: Survey;
  readonly base: VolumeBase;
  readonly baseHeightM: number | null;
  readonly result: {
    readonly cut: number;
    readonly fill: number;
    readonly net: Estimate;
    readonly surfaceArea: number;
    readonly filled: number;
    readonly cellM: number;
  };
}
export type Measurement =
  | PointMeasurement
  | DistanceMeasurement
  | ProfileMeasurement
  | AreaMeasurement
  | VolumeMeasurement;

export interface ControlMark {
  /** Name of the photo. */
  readonly photo: string;
  /** Pixels of the full photo from the outer corner of its upper left pixel. */
  readonly pixel: Vec2;
  /** The survey has no such photo. */
  readonly unknown?: true;
}
export interface ControlPoint {
  readonly name: string;
  /** Easting, northing, height in the CRS of the file; local metres without geo-reference. */
  readonly xyz: Vec3;
  readonly marks: readonly ControlMark[];
}

export interface KeyFrame {
  readonly name: string;
  readonly pose: CameraPose;
}
export interface CameraPath {
  readonly keys: readonly KeyFrame[];
  /** Metres per second between key frames. */
  readonly speedMps: number;
}

/** What is saved in the project and can be undone. */
export interface Documents {
  readonly measurements: readonly Measurement[];
  readonly controlPoints: readonly ControlPoint[];
  readonly cameraPath: CameraPath;
  readonly tour: Tour;
}

export interface Layers {
  readonly surface: boolean;
  readonly exact: boolean;
  readonly buildings: boolean;
  readonly blocks: boolean;
  readonly cameras: boolean;
  readonly points: boolean;
  readonly contours: boolean;
  /** Of `errorMap` and `trust` at most one is on (layers.ts). */
  readonly errorMap: boolean;
  readonly trust: boolean;
  readonly measurements: boolean;
  readonly controlPoints: boolean;
  readonly cameraPath: boolean;
  /** Labels, markers and models of the tour. */
  readonly things: boolean;
}

/** A box in ENU; only what is inside is shown. */
export interface ClipBox {
  readonly on: boolean;
  readonly min: Enu;
  readonly max: Enu;
}

/** Before/after: everything left of the line is the earlier project. `at`: 0 to 1 of the canvas width. */
export interface Swipe {
  readonly on: boolean;
  readonly at: number;
}

export type ToolName =
  | "navigate"
  | "point"
  | "distance"
  | "profile"
  | "area"
  | "volume"
  | "photos"
  | "control"
  | "thing";
export type Navigation = "map" | "fly" | "top";
export type PanelName = "layers" | "measure" | "buildings" | "photos" | "control" | "path" | "tour" | "about";

/** A photo that sees the chosen point. */
export interface PhotoSight {
  readonly photo: number;
  readonly pixel: Vec2;
  readonly distanceM: number;
  readonly gsdM: number;
  readonly visible: boolean;
}

/** A photo over the 3-D view with its render beside it. `split`: 0 shows the render, 1 the photo. */
export interface PhotoCompare {
  readonly photo: number;
  readonly split: number;
}

/** A picture that is laid over the ground between two corners; its colours go from 0 to `scale` (display values, 0 to 1). */
export interface DrapedMap {
  readonly url: string;
  readonly min: Vec2;
  readonly max: Vec2;
  readonly scale: number;
}

/** The error that held-out photos show. */
export interface ErrorMap extends DrapedMap {
  readonly photos: number;
  readonly ofPhotos: number;
}

export interface EngineStatus {
  readonly connected: boolean;
  readonly ready: boolean;
  readonly reason: string;
  readonly revision: number;
  readonly exposure: string;
  readonly clients: number;
  readonly ranks: number;
  /** Last finished pass of the view at rest: 0..passes-1; -1: none yet. */
  readonly pass: number;
  readonly passes: number;
}

/** Told about 10 times a second. */
export interface Readout {
  readonly cursor: SurfacePoint | null;
  /** Metres of the scene per CSS pixel at the middle of the view; null: nothing there. */
  readonly metresPerPx: number | null;
  /** Heading of the view, degrees clockwise from north; pitch, 0 level and -90 down. */
  readonly headingDeg: number;
  readonly pitchDeg: number;
  readonly fps: number;
}

export interface Notice {
  readonly id: number;
  readonly kind: "info" | "error";
  readonly text: string;
  /** Buttons, which run commands. */
  readonly actions: readonly NoticeAction[];
}

export interface NoticeAction {
  readonly label: string;
  readonly command: string;
}

export interface AppState {
  readonly documents: Documents;
  readonly tool: ToolName;
  /** Points of the measurement that is being made; the last one may follow the pointer in `hover`. */
  readonly draft: readonly SurfacePoint[];
  readonly hover: SurfacePoint | null;
  readonly volumeBase: VolumeBase;
  readonly volumeBaseHeightM: number;
  readonly selected: string | null;
  readonly selectedControl: string | null;
  readonly buildings: BuildingsState;
  /** Ids of buildings: the chosen one, and the one under the pointer. */
  readonly selectedBuilding: number | null;
  readonly hoverBuilding: number | null;
  readonly rights: Rights;
  readonly tour: TourView;
  /** Null: no tour is played. */
  readonly play: TourPlay | null;
  /** The picture of the ground, once it is needed. */
  readonly map: GroundMap | null;
  /** Brightness of the whole view, in stops. */
  readonly exposureStops: number;
  /** Ids of the measurements that are shown; null: all. */
  readonly shownMeasurements: readonly string[] | null;
  readonly navigation: Navigation;
  readonly panel: PanelName | null;
  readonly layers: Layers;
  readonly clip: ClipBox;
  readonly swipe: Swipe;
  readonly sights: {
    readonly point: SurfacePoint;
    readonly checked: boolean;
    readonly photos: readonly PhotoSight[];
  } | null;
  readonly compare: PhotoCompare | null;
  readonly errorMap: ErrorMap | null;
  /** The error to expect, from how well training photos agree with the field. */
  readonly trust: DrapedMap | null;
  readonly engine: EngineStatus;
  readonly readout: Readout;
  readonly notices: readonly Notice[];
  /** Requests under way: id to what it is and how far (0..1; null: unknown). */
  readonly busy: ReadonlyMap<number, { readonly what: string; readonly fraction: number | null }>;
  readonly save: "saved" | "saving" | "unsaved" | "failed";
  readonly help: boolean;
}
