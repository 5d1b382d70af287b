// measurements.geojson: a FeatureCollection (RFC 7946) that any GIS opens, in longitude, latitude and height (local metres without geo-reference).
// What GeoJSON has no place for (ENU points with their rays and spreads, the samples of profiles) is in members named "skyquilt".
import { CheckError } from "../base/check.js";
import type { Vec2, Vec3 } from "../base/vec.js";
import { geodeticFromEnu } from "../geo/earth.js";
import { outlineOffsetM } from "../geo/heights.js";
import type { Estimate } from "../geo/measure.js";
import { areaVector, pointSigma } from "../geo/measure.js";
import { mapFromEnu } from "../geo/projection.js";
import type { Measurement, SurfacePoint, Survey } from "./app_state.js";
import type { ProjectBase } from "./project.js";

export type MeasuredProject = Pick<
  ProjectBase,
  "origin" | "georeferenced" | "crs" | "accuracy" | "vertical" | "min" | "max" | "groundM"
>;
type Properties = Record<string, string | number | null>;

export const FILE_VERSION = 1;

export function writeMeasurements(measurements: readonly Measurement[], project: MeasuredProject): string {
  const document = {
    type: "FeatureCollection",
    features: measurements.map((measurement, i) => {
      requireFinite(measurement, `features[${i}]`);
      return {
        type: "Feature",
        id: measurement.id,
        geometry: geometryOf(measurement, project),
        properties: { name: measurement.name, kind: measurement.kind, ...properties(measurement, project) },
        skyquilt: extraOf(measurement),
      };
    }),
    skyquilt: {
      version: FILE_VERSION,
      georeferenced: project.georeferenced,
      origin: {
        latitude_deg: project.origin.latitudeDeg,
        longitude_deg: project.origin.longitudeDeg,
        height_m: project.origin.heightM,
      },
      heights: project.vertical,
    },
  };
  return `${JSON.stringify(document)}\n`;
}

/** JSON has no NaN: it would become null, and the file could not be read again. */
function requireFinite(measurement: Measurement, path: string): void {
  for (const { enu, direction, spreadM, pixelM } of measurement.points) {
    if (![...enu, ...direction, spreadM ?? 0, pixelM].every(Number.isFinite)) {
      throw new CheckError(path, "it has a number that is not finite: delete this measurement");
    }
  }
  for (const [key, value] of Object.entries(measuredProperties(measurement))) {
    if (typeof value === "number" && !Number.isFinite(value)) {
      throw new CheckError(`${path}.properties.${key}`, "it is not a finite number: delete this measurement");
    }
  }
}

function position(enu: Vec3, project: MeasuredProject): Vec3 {
  if (!project.georeferenced) return enu;
  const place = geodeticFromEnu(project, enu);
  return [place.longitudeDeg, place.latitudeDeg, place.heightM];
}

function geometryOf({ kind, points }: Measurement, project: MeasuredProject) {
  const positions = points.map(({ enu }) => position(enu, project));
  switch (kind) {
    case "point":
      return { type: "Point", coordinates: positions[0] ?? [] };
    case "distance":
    case "profile":
      return { type: "LineString", coordinates: positions };
    case "area":
    case "volume": {
      // RFC 7946: the outline turns to the left and ends where it begins.
      const left = areaVector(points.map(({ enu }) => enu))[2] >= 0;
      const ring = left ? positions : [...positions].reverse();
      return { type: "Polygon", coordinates: [[...ring, ...ring.slice(0, 1)]] };
    }
    default:
      return kind satisfies never;
  }
}

function estimate(name: string, unit: string, { value, sigma }: Estimate): Properties {
  return { [`${name}_${unit}`]: value, [`${name}_sigma_${unit}`]: sigma };
}

/** Only what was drawn on the earlier survey says so. */
function surveyOf(survey: Survey): Properties {
  return survey === "before" ? { survey } : {};
}

/** Results, which the reader takes from here. Units are in the names; sigma is one standard deviation. */
export function measuredProperties(measurement: Measurement): Properties {
  switch (measurement.kind) {
    case "point":
      return {};
    case "distance":
      return {
        ...estimate("slope", "m", measurement.result.slope),
        ...estimate("plan", "m", measurement.result.plan),
        ...estimate("rise", "m", measurement.result.rise),
      };
    case "profile":
      return { ...surveyOf(measurement.survey), length_m: measurement.lengthM };
    case "area":
      return {
        ...estimate("plan_area", "m2", measurement.result.plan),
        ...estimate("sloped_area", "m2", measurement.result.sloped),
        ...estimate("perimeter", "m", measurement.result.perimeter),
      };
    case "volume":
      return {
        ...surveyOf(measurement.survey),
        base: measurement.base,
        base_z_enu_m: measurement.baseHeightM,
        cut_m3: measurement.result.cut,
        fill_m3: measurement.result.fill,
        ...estimate("net", "m3", measurement.result.net),
        surface_area_m2: measurement.result.surfaceArea,
        filled_share: measurement.result.filled,
        cell_m: measurement.result.cellM,
      };
    default:
      return measurement satisfies never;
  }
}

/** With what is only for people: coordinates in the survey's CRS, the height of a base. Not read back. */
function properties(measurement: Measurement, project: MeasuredProject): Properties {
  const measured = measuredProperties(measurement);
  const first = measurement.points[0];
  if (measurement.kind === "point" && first !== undefined) return { ...measured, ...pointProperties(first, project) };
  if (measurement.kind === "volume" && measurement.baseHeightM !== null) {
    return { ...measured, base_height_m: measurement.baseHeightM + outlineOffsetM(project, measurement.points) };
  }
  return measured;
}

function pointProperties(point: SurfacePoint, project: MeasuredProject): Properties {
  const map = project.georeferenced ? mapFromEnu(project, point.enu) : null;
  const sigma = pointSigma(point, project.accuracy, middleOf(project));
  const sigmas = { horizontal_sigma_m: sigma.horizontalM, vertical_sigma_m: sigma.verticalM };
  if (map === null || project.crs === null) return sigmas;
  return { easting_m: map[0], northing_m: map[1], height_m: map[2], crs: project.crs.name, ...sigmas };
}

/** Where the accuracy of the place holds: about the middle of the survey, on the ground. */
export function middleOf({ min, max, groundM }: Pick<ProjectBase, "min" | "max" | "groundM">): Vec3 {
  const middle: Vec2 = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2];
  return [middle[0], middle[1], groundM];
}

function extraOf(measurement: Measurement) {
  const points = measurement.points.map(({ enu, direction, spreadM, pixelM, source }) => ({
    enu,
    direction,
    spread_m: spreadM,
    pixel_m: pixelM,
    source,
  }));
  if (measurement.kind !== "profile") return { points };
  return { points, heights_m: measurement.heightsM, spreads_m: measurement.spreadsM };
}
