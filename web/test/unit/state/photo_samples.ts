// Photos, and how they see a point.
import type { PhotoSight } from "../../../src/state/app_state.js";
import type { Photo } from "../../../src/state/project.js";

export const SAMPLE_PHOTOS: readonly Photo[] = ["A1.jpg", "a2.jpg", "b3.jpg"].map((name, index) => ({
  index,
  name,
  camera: 0,
  position: [0, 0, 0],
  rotation: [1, 0, 0, 0],
  isTest: false,
  psnrDb: null,
  available: true,
}));

export const sampleSight = (photo: number, gsdM: number, visible: boolean): PhotoSight => ({
  photo,
  gsdM,
  visible,
  pixel: [10, 20],
  distanceM: 1,
});

export const namesOf = (entries: readonly { readonly photo: Photo }[]): string[] =>
  entries.map((entry) => entry.photo.name);
