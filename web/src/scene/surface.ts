// A surface that can be drawn and picked: 3D Tiles, or the surface model under the orthophoto where there are none.
import type { BufferGeometry, Camera, Mesh, Object3D } from "three";
import type { Quality } from "./quality.js";
import type { Size } from "./view_math.js";

export interface Surface {
  readonly object: Object3D;
  /** Before each drawn frame: chooses what is shown. */
  update(camera: Camera, size: Size, quality: Quality): void;
  /** What is shown now, with its full geometry, whatever is drawn while the camera moves. */
  eachMesh(visit: (mesh: Mesh, geometry: BufferGeometry) => void): void;
  /** Something is still loading. */
  readonly busy: boolean;
  dispose(): void;
}

export interface SurfaceEvents {
  /** Another picture than before: a tile came, say. */
  changed(): void;
  /** For the user. */
  failed(text: string): void;
}
