// Reads measurements.geojson as measurements_file.ts writes it. Every error names the place in the file.
import {
  asArray,
  asBoolean,
  asChoice,
  asInteger,
  asList,
  asNumber,
  asObject,
  asString,
  asVec3,
  CheckError,
  type JsonObject,
  optional,
  optionalNumber,
} from "../base/check.js";
import type { Vec3 } from "../base/vec.js";
import { enuFromGeodetic, type Geodetic, geodeticFromEnu } from "../geo/earth.js";
import type { Estimate } from "../geo/measure.js";
import type { Measurement, SurfacePoint } from "./app_state.js";
import { FILE_VERSION, type MeasuredProject } from "./measurements_file.js";

const MOST_MEASUREMENTS = 100_000;
const MOST_POINTS = 100_000;
const KINDS = ["point", "distance", "profile", "area", "volume"] as const;
const BASES = ["plane", "lowest", "height", "before"] as const;
const SURVEYS = ["main", "before"] as const;
const LEAST_POINTS = { point: 1, distance: 2, profile: 2, area: 3, volume: 3 } as const;

/** From the ENU frame of the file into the project's. */
type Place = (enu: Vec3) => Vec3;

/** Throws CheckError. */
export function readMeasurements(value: unknown, project: MeasuredProject): readonly Measurement[] {
  const root = asObject(value, "");
  asChoice(root.type, "type", ["FeatureCollection"]);
  const extra = asObject(root.skyquilt, "skyquilt");
  asInteger(extra.version, "skyquilt.version", FILE_VERSION, FILE_VERSION);
  const place = placeOf(extra, project);
  const ids = new Set<string>();
  return asList(
    root.features,
    "features",
    (feature, path) => {
      const measurement = readFeature(feature, path, place);
      if (ids.has(measurement.id)) throw new CheckError(`${path}.id`, "another measurement has this id");
      ids.add(measurement.id);
      return measurement;
    },
    MOST_MEASUREMENTS,
  );
}

/** A project that was prepared again may have its origin elsewhere; places on Earth stay. */
function placeOf(extra: JsonObject, project: MeasuredProject): Place {
  const georeferenced = asBoolean(extra.georeferenced, "skyquilt.georeferenced");
  if (georeferenced !== project.georeferenced) {
    const [was, is] = georeferenced ? ["with", "none"] : ["without", "one now"];
    throw new CheckError("skyquilt.georeferenced", `it was saved ${was} a geo-reference, and the project has ${is}`);
  }
  const given = asObject(extra.origin, "skyquilt.origin");
  const origin: Geodetic = {
    latitudeDeg: asNumber(given.latitude_deg, "skyquilt.origin.latitude_deg", -90, 90),
    longitudeDeg: asNumber(given.longitude_deg, "skyquilt.origin.longitude_deg", -360, 360),
    heightM: asNumber(given.height_m, "skyquilt.origin.height_m"),
  };
  const now = project.origin;
  const same =
    origin.latitudeDeg === now.latitudeDeg &&
    origin.longitudeDeg === now.longitudeDeg &&
    origin.heightM === now.heightM;
  if (same || !georeferenced) return (enu) => enu;
  return (enu) => enuFromGeodetic(project, geodeticFromEnu({ origin }, enu));
}

function readFeature(value: unknown, path: string, place: Place): Measurement {
  const feature = asObject(value, path);
  asChoice(feature.type, `${path}.type`, ["Feature"]);
  const at = `${path}.properties`;
  const properties = asObject(feature.properties, at);
  const extraPath = `${path}.skyquilt`;
  const extra = asObject(feature.skyquilt, extraPath);
  const kind = asChoice(properties.kind, `${at}.kind`, KINDS);
  const points = asList(
    extra.points,
    `${extraPath}.points`,
    (point, pointPath) => readPoint(point, pointPath, place),
    MOST_POINTS,
  );
  if (points.length < LEAST_POINTS[kind]) {
    throw new CheckError(
      `${extraPath}.points`,
      `a ${kind} needs at least ${LEAST_POINTS[kind]}, found ${points.length}`,
    );
  }
  const base = {
    id: asString(feature.id, `${path}.id`, 100),
    name: asString(properties.name, `${at}.name`, 1000),
    points,
  };
  const number = (key: string, min?: number) => asNumber(properties[key], `${at}.${key}`, min);
  const estimate = (name: string, unit: string): Estimate => ({
    value: number(`${name}_${unit}`),
    sigma: optional(properties[`${name}_sigma_${unit}`], `${at}.${name}_sigma_${unit}`, (given, where) =>
      asNumber(given, where, 0),
    ),
  });
  const survey = () =>
    optional(properties.survey, `${at}.survey`, (given, where) => asChoice(given, where, SURVEYS)) ?? "main";
  switch (kind) {
    case "point":
      return { ...base, kind };
    case "distance":
      return {
        ...base,
        kind,
        result: { slope: estimate("slope", "m"), plan: estimate("plan", "m"), rise: estimate("rise", "m") },
      };
    case "profile":
      return {
        ...base,
        kind,
        survey: survey(),
        lengthM: number("length_m", 0),
        ...readSamples(extra, extraPath, place),
      };
    case "area":
      return {
        ...base,
        kind,
        result: {
          plan: estimate("plan_area", "m2"),
          sloped: estimate("sloped_area", "m2"),
          perimeter: estimate("perimeter", "m"),
        },
      };
    case "volume":
      return {
        ...base,
        kind,
        survey: survey(),
        base: asChoice(properties.base, `${at}.base`, BASES),
        baseHeightM: movedLevel(
          optionalNumber(properties.base_z_enu_m, `${at}.base_z_enu_m`),
          firstEnu(extra, extraPath),
          place,
        ),
        result: {
          cut: number("cut_m3", 0),
          fill: number("fill_m3", 0),
          net: estimate("net", "m3"),
          surfaceArea: number("surface_area_m2", 0),
          filled: asNumber(properties.filled_share, `${at}.filled_share`, 0, 1),
          cellM: number("cell_m", 0),
        },
      };
    default:
      return kind satisfies never;
  }
}

/** First corner in the frame of the file. */
function firstEnu(extra: JsonObject, path: string): Vec3 {
  const [first] = asArray(extra.points, `${path}.points`);
  return asVec3(asObject(first, `${path}.points[0]`).enu, `${path}.points[0].enu`);
}

/** A level of the file's frame in the project's, at this corner. */
function movedLevel(z: number | null, corner: Vec3, place: Place): number | null {
  return z === null ? null : place([corner[0], corner[1], z])[2];
}

function readPoint(value: unknown, path: string, place: Place): SurfacePoint {
  const point = asObject(value, path);
  return {
    enu: place(asVec3(point.enu, `${path}.enu`)),
    direction: asVec3(point.direction, `${path}.direction`),
    spreadM: optional(point.spread_m, `${path}.spread_m`, (given, at) => asNumber(given, at, 0)),
    pixelM: asNumber(point.pixel_m, `${path}.pixel_m`, 0),
    source: asChoice(point.source, `${path}.source`, ["mesh", "field"]),
  };
}

function readSamples(extra: JsonObject, path: string, place: Place) {
  const corner = firstEnu(extra, path);
  const numbers = (key: string): (number | null)[] =>
    asArray(extra[key], `${path}.${key}`, MOST_POINTS).map((entry, i) => optionalNumber(entry, `${path}.${key}[${i}]`));
  const heightsM = numbers("heights_m").map((z) => movedLevel(z, corner, place));
  const spreadsM = numbers("spreads_m");
  if (heightsM.length !== spreadsM.length) {
    throw new CheckError(`${path}.spreads_m`, `${heightsM.length} entries expected, found ${spreadsM.length}`);
  }
  return { heightsM, spreadsM };
}
