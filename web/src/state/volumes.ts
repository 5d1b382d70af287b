// Volumes: the engine measures, this adds the deviation and puts the result into the documents.
import type { Vec2 } from "../base/vec.js";
import { crossesItself, volume } from "../geo/measure.js";
import type { SurfacePoint, Survey, VolumeBase, VolumeMeasurement } from "./app_state.js";
import { changeMeasurement } from "./measurements.js";
import type { Accuracy, Project } from "./project.js";
import type { Store } from "./store.js";

export const MOST_CORNERS = 64;

/** What measuring volumes needs of the project. */
export interface VolumeProject {
  readonly accuracy: Accuracy;
  readonly before: Pick<NonNullable<Project["before"]>, "accuracy"> | null;
}

/** Where the surface and the level that it is measured against lie in the vertical. */
export interface VolumeLevel {
  readonly base: VolumeBase;
  /** The surface that was measured; against the earlier survey it is always the present one. */
  readonly survey: Survey;
}

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
    project?: Survey,
  ): Promise<{
    readonly cellM: number;
    readonly filled: number;
    readonly planAreaM2: number;
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

/** The survey whose surface is measured over this base. */
export function measuredSurvey({ base, survey }: VolumeLevel): Survey {
  return base === "before" ? "main" : survey;
}

/** Accuracy of the survey whose surface is measured; null: that survey is not open. */
function surveyAccuracy(project: VolumeProject, level: VolumeLevel): Accuracy | null {
  return measuredSurvey(level) === "before" ? (project.before?.accuracy ?? null) : project.accuracy;
}

/** One standard deviation of the level against the surface: all of it moves together. 0 for bases that move with the surface; null: unknown. */
export function levelSigmaM(project: VolumeProject, level: VolumeLevel): number | null {
  const verticalM = surveyAccuracy(project, level)?.verticalM ?? null;
  if (level.base === "height") return verticalM;
  if (level.base !== "before") return 0;
  const beforeM = project.before?.accuracy.verticalM ?? null;
  return verticalM === null || beforeM === null ? null : Math.hypot(verticalM, beforeM);
}

/** `baseHeightM`: z of ENU; counts for the base "height" only. */
export async function measureVolume(
  source: VolumeSource,
  project: VolumeProject,
  points: readonly SurfacePoint[],
  base: VolumeBase,
  baseHeightM: number,
  survey: Survey = "main",
): Promise<VolumeMeasurement["result"]> {
  const level: VolumeLevel = { base, survey };
  const accuracy = surveyAccuracy(project, level);
  if (accuracy === null) {
    throw new Error("it lies on the earlier survey, which is not open: start the viewer with --compare");
  }
  const outline = points.map(({ enu }): Vec2 => [enu[0], enu[1]]);
  const reply = await source.volume(outline, base, base === "height" ? baseHeightM : 0, measuredSurvey(level));
  const levelM3 = (levelSigmaM(project, level) ?? 0) * reply.planAreaM2;
  const sigmaM3 = reply.sigmaM3 === null ? null : Math.hypot(reply.sigmaM3, levelM3);
  return {
    cut: reply.cutM3,
    fill: reply.fillM3,
    net: volume(reply.netM3, sigmaM3, points, accuracy),
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
  project: VolumeProject,
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
    const result = await measureVolume(source, project, found.points, base, baseHeightM, found.survey);
    if (requests.get(id) !== own) return;
    store.changeDocuments("change the volume's base", (documents) =>
      changeMeasurement(documents, id, (measurement) =>
        // Meanwhile another volume may have come to this id.
        measurement.kind === "volume" && measurement.points === found.points
          ? { ...measurement, base, baseHeightM: base === "height" ? baseHeightM : null, result }
          : measurement,
      ),
    );
  } finally {
    if (requests.get(id) === own) requests.delete(id);
  }
}
