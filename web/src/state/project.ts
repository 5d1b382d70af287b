// The project as the server describes it (project.json, docs/viewer_protocol.md), after it was checked by protocol/project_reader.ts.
import type { Quat, Vec3 } from "../base/vec.js";

export interface Crs {
  readonly name: string;
  /** UTM zone 1 to 60; 0: UPS. */
  readonly zone: number;
  readonly north: boolean;
}
export interface Accuracy {
  readonly scalePercent: number | null;
  readonly tiltDeg: number | null;
  readonly yawDeg: number | null;
  readonly horizontalM: number | null;
  readonly verticalM: number | null;
}
export interface Block {
  readonly name: string;
  readonly min: Vec3;
  readonly max: Vec3;
  readonly empty: boolean;
  readonly photos: number;
  readonly psnrDb: number | null;
}
export interface PhotoCamera {
  readonly model: string;
  readonly width: number;
  readonly height: number;
  readonly params: readonly number[];
}
export interface Photo {
  readonly index: number;
  readonly name: string;
  readonly camera: number;
  readonly position: Vec3;
  readonly rotation: Quat;
  readonly isTest: boolean;
  readonly psnrDb: number | null;
  readonly available: boolean;
}
export interface Missing {
  readonly what: string;
  readonly reason: string;
  readonly advice: string;
}
export interface ProjectBase {
  readonly name: string;
  readonly revision: number;
  readonly georeferenced: boolean;
  readonly origin: { readonly latitudeDeg: number; readonly longitudeDeg: number; readonly heightM: number };
  readonly crs: Crs | null;
  readonly vertical: string;
  readonly accuracy: Accuracy;
  readonly min: Vec3;
  readonly max: Vec3;
  readonly groundM: number;
  readonly gsdM: number;
  readonly scene: { readonly blocks: number; readonly parameters: number; readonly trust: boolean } | null;
  /** Absolute URLs of this server, or null. */
  readonly tiles: string | null;
  readonly terrain: string | null;
  readonly orthophoto: string | null;
  readonly points: string | null;
  readonly contours: string | null;
  readonly surface: {
    readonly triangles: number;
    readonly points: number;
    readonly areaM2: number;
    readonly voxelM: number;
  } | null;
  /** What `skyquilt buildings` has found: URLs of buildings.json and of the other files. */
  readonly buildings: { readonly count: number; readonly url: string; readonly files: readonly string[] } | null;
  readonly blocks: readonly Block[];
  readonly cameras: readonly PhotoCamera[];
  readonly photos: readonly Photo[];
  readonly metrics: Readonly<Record<string, number | null>> | null;
  readonly missing: readonly Missing[];
}
export interface Project extends ProjectBase {
  readonly before: (ProjectBase & { readonly enuFromBefore: readonly number[] }) | null;
}

/** URL of a photo's picture. */
export function photoUrl(photo: number, size: "thumbnail" | "photo" | "full"): string {
  return `/data/photos/${photo}/${size}.jpg`;
}
