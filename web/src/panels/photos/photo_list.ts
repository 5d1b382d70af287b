// Which photos the photo panel lists, and in which order.
import type { PhotoSight } from "../../state/app_state.js";
import type { Photo } from "../../state/project.js";

export interface PhotoEntry {
  readonly photo: Photo;
  /** How the photo sees the chosen point; null when no point is chosen. */
  readonly sight: PhotoSight | null;
}

export const PAGE = 50;

/** All photos in the survey's order, or those that look at the chosen point: visible ones first, finest first, then the hidden ones. */
export function listPhotos(
  photos: readonly Photo[],
  sights: readonly PhotoSight[] | null,
  search: string,
): readonly PhotoEntry[] {
  const wanted = search.trim().toLowerCase();
  const named = (photo: Photo): boolean => wanted === "" || photo.name.toLowerCase().includes(wanted);
  if (sights === null) return photos.filter(named).map((photo) => ({ photo, sight: null }));
  const entries: PhotoEntry[] = [];
  for (const sight of sights) {
    const photo = photos[sight.photo];
    if (photo !== undefined && named(photo)) entries.push({ photo, sight });
  }
  return entries.sort(compareSights);
}

function compareSights(a: PhotoEntry, b: PhotoEntry): number {
  if (a.sight === null || b.sight === null) return 0;
  if (a.sight.visible !== b.sight.visible) return a.sight.visible ? -1 : 1;
  return a.sight.gsdM - b.sight.gsdM;
}

/** The photo `step` places on in this list, round the end; the first when `photo` is not in it; null: the list is empty. */
export function stepPhoto(entries: readonly PhotoEntry[], photo: number, step: number): number | null {
  if (entries.length === 0) return null;
  const at = entries.findIndex((entry) => entry.photo.index === photo);
  const next = at < 0 ? 0 : (((at + step) % entries.length) + entries.length) % entries.length;
  return entries[next]?.photo.index ?? null;
}
