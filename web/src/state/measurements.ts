// Making and changing measurements, as pure functions of the documents.
import type { Vec2 } from "../base/vec.js";
import { heightOffsetM, outlineOffsetM } from "../geo/heights.js";
import { area, distance } from "../geo/measure.js";
import type {
  DistanceMeasurement,
  Documents,
  Measurement,
  PointMeasurement,
  SurfacePoint,
  Survey,
  VolumeBase,
  VolumeMeasurement,
} from "./app_state.js";
import { freeName } from "./names.js";
import type { Accuracy, ProjectBase } from "./project.js";

export type MeasurementKind = Measurement["kind"];
/** What results need of the project. */
export type ResultProject = Pick<ProjectBase, "accuracy" | "origin" | "georeferenced">;

export const KIND_LABELS: Readonly<Record<MeasurementKind, string>> = {
  point: "Point",
  distance: "Distance",
  profile: "Profile",
  area: "Area",
  volume: "Volume",
};

export interface ProfileSamples {
  readonly lengthM: number;
  readonly heightsM: readonly (number | null)[];
  readonly spreadsM: readonly (number | null)[];
}

/** Id and name that no measurement has yet. */
function label(documents: Documents, kind: MeasurementKind): { readonly id: string; readonly name: string } {
  const numbers = documents.measurements.map(({ id }) => Number(/^m(\d{1,9})$/.exec(id)?.[1] ?? 0));
  return {
    id: `m${Math.max(0, ...numbers) + 1}`,
    name: freeName(
      KIND_LABELS[kind],
      documents.measurements.map(({ name }) => name),
    ),
  };
}

export function newPoint(documents: Documents, points: readonly SurfacePoint[]): PointMeasurement {
  return { ...label(documents, "point"), kind: "point", points };
}

export function newDistance(
  documents: Documents,
  points: readonly SurfacePoint[],
  project: ResultProject,
): Measurement {
  return { ...label(documents, "distance"), kind: "distance", points, result: distanceResult(points, project) };
}

/** The height difference is that of heights in the survey's system: over long distances z of ENU has the Earth's curvature in it. */
function distanceResult(points: readonly SurfacePoint[], project: ResultProject): DistanceMeasurement["result"] {
  const result = distance(points, project.accuracy);
  const offsetM = (point: SurfacePoint | undefined) =>
    point === undefined ? 0 : heightOffsetM(project, [point.enu[0], point.enu[1]], point.enu[2]);
  const moreM = offsetM(points[points.length - 1]) - offsetM(points[0]);
  return { ...result, rise: { ...result.rise, value: result.rise.value + moreM } };
}

export function newArea(documents: Documents, points: readonly SurfacePoint[], accuracy: Accuracy): Measurement {
  return { ...label(documents, "area"), kind: "area", points, result: area(points, accuracy) };
}

/**
 * Heights to a tenth of a millimetre: what is beyond would only fill the file. Kept is z of ENU at the middle of the profile, so that adding
 * outlineOffsetM gives each sample's height in the survey's system.
 */
export function newProfile(
  documents: Documents,
  points: readonly SurfacePoint[],
  samples: ProfileSamples,
  project: ResultProject,
  survey: Survey = "main",
): Measurement {
  const middleM = outlineOffsetM(project, points);
  const last = Math.max(1, samples.heightsM.length - 1);
  const levelled = (z: number | null, i: number) =>
    z === null ? null : z + heightOffsetM(project, placeAlong(points, i / last), z) - middleM;
  const short = (value: number | null) =>
    value === null || !Number.isFinite(value) ? null : Math.round(value * 1e4) / 1e4;
  return {
    ...label(documents, "profile"),
    kind: "profile",
    survey,
    points,
    lengthM: samples.lengthM,
    heightsM: samples.heightsM.map((z, i) => short(levelled(z, i))),
    spreadsM: samples.spreadsM.map(short),
  };
}

/** In plan, at a share of the way from the first point to the last. */
function placeAlong(points: readonly SurfacePoint[], share: number): Vec2 {
  const a = points[0]?.enu ?? [0, 0, 0];
  const b = points[points.length - 1]?.enu ?? a;
  return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
}

export function newVolume(
  documents: Documents,
  points: readonly SurfacePoint[],
  base: VolumeBase,
  baseHeightM: number | null,
  result: VolumeMeasurement["result"],
  survey: Survey = "main",
): Measurement {
  return { ...label(documents, "volume"), kind: "volume", survey, points, base, baseHeightM, result };
}

export function withMeasurement(documents: Documents, measurement: Measurement): Documents {
  return { ...documents, measurements: [...documents.measurements, measurement] };
}

export function withoutMeasurement(documents: Documents, id: string): Documents {
  const measurements = documents.measurements.filter((measurement) => measurement.id !== id);
  return measurements.length === documents.measurements.length ? documents : { ...documents, measurements };
}

/** Unchanged when there is none of this id, or `change` returns the same. */
export function changeMeasurement(
  documents: Documents,
  id: string,
  change: (measurement: Measurement) => Measurement,
): Documents {
  let changed = false;
  const measurements = documents.measurements.map((measurement) => {
    if (measurement.id !== id) return measurement;
    const next = change(measurement);
    changed ||= next !== measurement;
    return next;
  });
  return changed ? { ...documents, measurements } : documents;
}

/** The results that follow from the points are computed again; those of the engine stay. */
function withPoints(measurement: Measurement, points: readonly SurfacePoint[], project: ResultProject): Measurement {
  switch (measurement.kind) {
    case "distance":
      return { ...measurement, points, result: distanceResult(points, project) };
    case "area":
      return { ...measurement, points, result: area(points, project.accuracy) };
    case "point":
    case "profile":
    case "volume":
      return { ...measurement, points };
    default:
      return measurement satisfies never;
  }
}

/** Puts `found` where `picked` (this very object) is. */
export function replacePoint(
  documents: Documents,
  picked: SurfacePoint,
  found: SurfacePoint,
  project: ResultProject,
): Documents {
  if (!documents.measurements.some(({ points }) => points.includes(picked))) return documents;
  return {
    ...documents,
    measurements: documents.measurements.map((measurement) =>
      measurement.points.includes(picked)
        ? withPoints(
            measurement,
            measurement.points.map((point) => (point === picked ? found : point)),
            project,
          )
        : measurement,
    ),
  };
}
