// What panels get: the project, the store, and the interfaces of scene, engine, tools and tour.
import type { Link } from "../protocol/link_api.js";
import type { SceneApi } from "../scene/scene_api.js";
import type { CommandTable } from "../state/commands.js";
import type { Project } from "../state/project.js";
import type { Store } from "../state/store.js";
import type { NamedAsset } from "../tour/edit_assets.js";

export type AssetKind = "picture" | "model";

/** Pictures and models of the tour. */
export interface TourAssets {
  url(asset: string): string;
  /** Rejects with an Error for the user. */
  upload(file: File, kind: AssetKind, onProgress: (fraction: number) => void): Promise<NamedAsset>;
}

/** Playing the tour; what is played is in the store. */
export interface TourControls {
  /** From this stop; without one from the beginning. */
  play(stop?: string): void;
  leave(): void;
  next(): void;
  previous(): void;
  goTo(stop: string): void;
  /** One of the branches of the stop where one is. */
  takeBranch(branch: number): void;
  /** Goes on by itself, or with a way that was halted. */
  resume(): void;
  /** Halts the way, or keeps autoplay at its stop. */
  pause(): void;
  /** To the view of the stop where one has looked around. */
  back(): void;
}

/** What playing a tour needs. */
export interface PlayContext {
  readonly project: Project;
  readonly store: Store;
  readonly scene: SceneApi;
  readonly commands: CommandTable;
  /** The address of a picture; a promise where it is made of bytes first, which rejects when they are not there. */
  readonly assets: { url(asset: string): string | Promise<string> };
  readonly controls: TourControls;
}

export interface AppContext extends PlayContext {
  readonly link: Link;
  readonly assets: TourAssets;
  /** The control points of a gcp_list.txt as gcp.json. Rejects with an Error for the user. */
  convertGcpList(list: string): Promise<string>;
}
