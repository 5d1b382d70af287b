// Making and changing measurements, as pure functions of the documents.
import { area, distance } from "../geo/measure.js";
import type {
  Documents,
  Measurement,
  PointMeasurement,
  SurfacePoint,
  VolumeBase,
  VolumeMeasurement,
} from "./app_state.js";
import { freeName } from "./names.js";
import type { Accuracy } from "./project.js";

export type MeasurementKind = Measurement["kind"];

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

export function newDistance(documents: Documents, points: readonly SurfacePoint[], accuracy: Accuracy): Measurement {
  return { ...label(documents, "distance"), kind: "distance", points, result: distance(points, accuracy) };
}

export function newArea(documents: Documents, points: readonly SurfacePoint[], accuracy: Accuracy): Measurement {
  return { ...label(documents, "area"), kind: "area", points, result: area(points, accuracy) };
}

/** Heights to a tenth of a millimetre: what is beyond would only fill the file. */
export function newProfile(
  documents: Documents,
  points: readonly SurfacePoint[],
  samples: ProfileSamples,
): Measurement {
  const short = (value: number | null) =>
    value === null || !Number.isFinite(value) ? null : Math.round(value * 1e4) / 1e4;
  return {
    ...label(documents, "profile"),
    kind: "profile",
    points,
    lengthM: samples.lengthM,
    heightsM: samples.heightsM.map(short),
    spreadsM: samples.spreadsM.map(short),
  };
}

export function newVolume(
  documents: Documents,
  points: readonly SurfacePoint[],
  base: VolumeBase,
  baseHeightM: number | null,
  result: VolumeMeasurement["result"],
): Measurement {
  return { ...label(documents, "volume"), kind: "volume", points, base, baseHeightM, result };
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
function withPoints(measurement: Measurement, points: readonly SurfacePoint[], accuracy: Accuracy): Measurement {
  switch (measurement.kind) {
    case "distance":
      return { ...measurement, points, result: distance(points, accuracy) };
    case "area":
      return { ...measurement, points, result: area(points, accuracy) };
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
  accuracy: Accuracy,
): Documents {
  if (!documents.measurements.some(({ points }) => points.includes(picked))) return documents;
  return {
    ...documents,
    measurements: documents.measurements.map((measurement) =>
      measurement.points.includes(picked)
        ? withPoints(
            measurement,
            measurement.points.map((point) => (point === picked ? found : point)),
            accuracy,
          )
        : measurement,
    ),
  };
}
