// Volumes: the engine measures, this adds the deviation and puts the result into the documents.
import type { Vec2, Vec3 } from "../base/vec.js";
import { geodeticFromEnu } from "../geo/earth.js";
import { crossesItself, middleInPlan, volume } from "../geo/measure.js";
import type { SurfacePoint, VolumeBase, VolumeMeasurement } from "./app_state.js";
import { changeMeasurement } from "./measurements.js";
import type { Accuracy, ProjectBase } from "./project.js";
import type { Store } from "./store.js";

export const MOST_CORNERS = 64;

export const BASE_LABELS: Readonly<Record<VolumeBase, string>> = {
  plane: "plane through the corners",
  lowest: "level of the lowest corner",
  height: "level at a height",
  before: "the earlier survey",
};

/** The part of the connection that this needs (protocol/link_api.ts, Link). */
export interface VolumeSource {
  volume(
    polygon: readonly Vec2[],
    base: VolumeBase,
    baseHeightM: number,
  ): Promise<{
    readonly cellM: number;
    readonly filled: number;
    readonly surfaceAreaM2: number;
    readonly cutM3: number;
    readonly fillM3: number;
    readonly netM3: number;
    readonly sigmaM3: number | null;
  }>;
}

/** Why these corners have no area or volume; null: they have. */
export function outlineProblem(points: readonly SurfacePoint[], most = Number.POSITIVE_INFINITY): string | null {
  if (points.length < 3) return "An outline needs at least three points.";
  if (points.length > most)
    return `The outline of a volume can have at most ${most} points: take some away with Backspace.`;
  if (crossesItself(points.map(({ enu }): Vec2 => [enu[0], enu[1]]))) {
    return "The outline crosses or touches itself: take points away with Backspace.";
  }
  return null;
}

/** `baseHeightM`: z of ENU; counts for the base "height" only. */
export async function measureVolume(
  source: VolumeSource,
  accuracy: Accuracy,
  points: readonly SurfacePoint[],
  base: VolumeBase,
  baseHeightM: number,
): Promise<VolumeMeasurement["result"]> {
  const outline = points.map(({ enu }): Vec2 => [enu[0], enu[1]]);
  const reply = await source.volume(outline, base, base === "height" ? baseHeightM : 0);
  return {
    cut: reply.cutM3,
    fill: reply.fillM3,
    net: volume(reply.netM3, reply.sigmaM3, points, accuracy),
    surfaceArea: reply.surfaceAreaM2,
    filled: reply.filled,
    cellM: reply.cellM,
  };
}

/** The newest request for each volume; answers of older ones are dropped. */
const newest = new WeakMap<Store, Map<string, symbol>>();

/** Measures a finished volume over another base, as one step that can be undone. Rejects with what the engine says. */
export async function remeasureVolume(
  store: Store,
  source: VolumeSource,
  accuracy: Accuracy,
  id: string,
  base: VolumeBase,
  baseHeightM: number,
): Promise<void> {
  const found = store.get().documents.measurements.find((measurement) => measurement.id === id);
  if (found?.kind !== "volume") return;
  const requests = newest.get(store) ?? new Map<string, symbol>();
  newest.set(store, requests);
  const own = Symbol(id);
  requests.set(id, own);
  try {
    const result = await measureVolume(source, accuracy, found.points, base, baseHeightM);
    if (requests.get(id) !== own) return;
    store.changeDocuments("change the volume's base", (documents) =>
      changeMeasurement(documents, id, (measurement) =>
        measurement.kind === "volume"
          ? { ...measurement, base, baseHeightM: base === "height" ? baseHeightM : null, result }
          : measurement,
      ),
    );
  } finally {
    if (requests.get(id) === own) requests.delete(id);
  }
}

/** Height in the survey's system minus z of ENU at this place; 0 without geo-reference. */
export function heightOffsetM(project: Pick<ProjectBase, "origin" | "georeferenced">, at: Vec2, z: number): number {
  if (!project.georeferenced) return 0;
  const offset = geodeticFromEnu(project, [at[0], at[1], z]).heightM - z;
  return Number.isFinite(offset) ? offset : 0;
}

/** Offset at the middle of these corners. */
export function outlineOffsetM(
  project: Pick<ProjectBase, "origin" | "georeferenced">,
  points: readonly { readonly enu: Vec3 }[],
): number {
  const z = points.reduce((sum, point) => sum + point.enu[2], 0) / Math.max(1, points.length);
  return heightOffsetM(project, middleInPlan(points.map((point) => point.enu)), z);
}
