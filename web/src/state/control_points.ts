// Changes of the control points as pure functions.
import type { Vec2 } from "../base/vec.js";
import type { ControlPoint, Documents, PhotoSight } from "./app_state.js";
import type { Photo } from "./project.js";

export function withPoint(
  documents: Documents,
  name: string,
  change: (point: ControlPoint) => ControlPoint,
): Documents {
  return {
    ...documents,
    controlPoints: documents.controlPoints.map((point) => (point.name === name ? change(point) : point)),
  };
}

export function withoutPoint(documents: Documents, name: string): Documents {
  return { ...documents, controlPoints: documents.controlPoints.filter((point) => point.name !== name) };
}

/** A point has one mark per photo; null takes it away. */
export function withMark(point: ControlPoint, photo: string, pixel: Vec2 | null): ControlPoint {
  const others = point.marks.filter((mark) => mark.photo !== photo);
  return { ...point, marks: pixel === null ? others : [...others, { photo, pixel }] };
}

/** Points of the same name get the loaded coordinates; marks in the same photo are replaced, the others stay. */
export function mergeControlPoints(
  existing: readonly ControlPoint[],
  loaded: readonly ControlPoint[],
): readonly ControlPoint[] {
  const merged = new Map(existing.map((point) => [point.name, point]));
  for (const point of loaded) {
    const old = merged.get(point.name);
    const kept = (old?.marks ?? []).filter((mark) => !point.marks.some((other) => other.photo === mark.photo));
    merged.set(point.name, { ...point, marks: [...kept, ...point.marks] });
  }
  return [...merged.values()];
}

/** "GCP_1", or the first number that is free. Names are words in gcp_list.txt: no spaces. */
export function freePointName(taken: ReadonlySet<string>): string {
  for (let number = 1; ; number += 1) {
    if (!taken.has(`GCP_${number}`)) return `GCP_${number}`;
  }
}

export interface MarkEntry {
  readonly photo: Photo;
  /** Where the point should lie, pixels of the photo; null: not known. */
  readonly predicted: Vec2 | null;
  readonly visible: boolean;
  readonly mark: Vec2 | null;
}

/** Photos of a point: marked ones first, then those that should see it, finest first, then those where it is hidden. */
export function markEntries(
  point: ControlPoint,
  photos: readonly Photo[],
  sights: readonly PhotoSight[],
): readonly MarkEntry[] {
  const marks = new Map(point.marks.map((mark) => [mark.photo, mark.pixel]));
  const seen = new Set<number>();
  const entries: MarkEntry[] = [];
  for (const sight of [...sights].sort((a, b) => a.gsdM - b.gsdM)) {
    const photo = photos[sight.photo];
    if (photo === undefined || seen.has(photo.index)) continue;
    seen.add(photo.index);
    entries.push({ photo, predicted: sight.pixel, visible: sight.visible, mark: marks.get(photo.name) ?? null });
  }
  for (const photo of photos) {
    const mark = marks.get(photo.name);
    if (mark !== undefined && !seen.has(photo.index)) entries.push({ photo, predicted: null, visible: true, mark });
  }
  const rank = (entry: MarkEntry): number => (entry.mark !== null ? 0 : entry.visible ? 1 : 2);
  return entries.sort((a, b) => rank(a) - rank(b));
}

/** Distance between predicted place and mark, pixels. */
export function residualPx(entry: MarkEntry): number | null {
  if (entry.mark === null || entry.predicted === null) return null;
  return Math.hypot(entry.predicted[0] - entry.mark[0], entry.predicted[1] - entry.mark[1]);
}
