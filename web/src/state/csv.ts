// Measurements as CSV (RFC 4180): what spreadsheets open. Numbers have a decimal point and no unit; shapes are WKT, which GIS read.
import { geodeticFromEnu } from "../geo/earth.js";
import type { Estimate } from "../geo/measure.js";
import { pointSigma } from "../geo/measure.js";
import { mapFromEnu } from "../geo/projection.js";
import type { Measurement, ProfileMeasurement, SurfacePoint } from "./app_state.js";
import { type MeasuredProject, middleOf } from "./measurements_file.js";

type Cell = string | number | null;

/** One cell. Spreadsheets take text that begins with = + - @ for a formula: a quote before it makes it text. Numbers are not touched. */
function cell(value: Cell): string {
  if (value === null) return "";
  if (typeof value === "number") return Number.isFinite(value) ? String(value) : "";
  const safe = /^[\s]*[=+\-@]/.test(value) || /^[\t\r\n]/.test(value) ? `'${value}` : value;
  return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

export function csvText(rows: readonly (readonly Cell[])[]): string {
  return rows.map((row) => `${row.map(cell).join(",")}\r\n`).join("");
}

function rounded(value: number | null, digits: number): number | null {
  return value === null || !Number.isFinite(value) ? null : Number(value.toFixed(digits));
}

const COLUMNS = [
  "name",
  "kind",
  "value",
  "sigma",
  "unit",
  "plan_m",
  "plan_sigma_m",
  "rise_m",
  "rise_sigma_m",
  "sloped_m2",
  "sloped_sigma_m2",
  "perimeter_m",
  "perimeter_sigma_m",
  "cut_m3",
  "fill_m3",
  "base",
  "coordinates",
  "crs",
] as const;
type Row = Partial<Record<(typeof COLUMNS)[number], Cell>>;

/** One row per measurement. `value` is the main result: height, slope distance, length, plan area, net volume; sigma one standard deviation. */
export function measurementsCsv(measurements: readonly Measurement[], project: MeasuredProject): string {
  const crs = project.georeferenced ? (project.crs?.name ?? "WGS84 longitude latitude") : "local metres";
  const rows = measurements.map((measurement) => {
    const row: Row = {
      name: measurement.name,
      kind: measurement.kind,
      ...resultCells(measurement, project),
      coordinates: wkt(measurement, project),
      crs,
    };
    return COLUMNS.map((column) => row[column] ?? null);
  });
  return csvText([COLUMNS, ...rows]);
}

function main({ value, sigma }: Estimate, unit: string): Row {
  return { value: rounded(value, 4), sigma: rounded(sigma, 4), unit };
}

function resultCells(measurement: Measurement, project: MeasuredProject): Row {
  switch (measurement.kind) {
    case "point": {
      const point = measurement.points[0];
      if (point === undefined) return {};
      const { verticalM } = pointSigma(point, project.accuracy, middleOf(project));
      return main({ value: coordinates(point, project)[2] ?? Number.NaN, sigma: verticalM }, "m");
    }
    case "distance": {
      const { slope, plan, rise } = measurement.result;
      return {
        ...main(slope, "m"),
        plan_m: rounded(plan.value, 4),
        plan_sigma_m: rounded(plan.sigma, 4),
        rise_m: rounded(rise.value, 4),
        rise_sigma_m: rounded(rise.sigma, 4),
      };
    }
    case "profile":
      return main({ value: measurement.lengthM, sigma: null }, "m");
    case "area": {
      const { sloped, plan, perimeter } = measurement.result;
      return {
        ...main(plan, "m2"),
        sloped_m2: rounded(sloped.value, 4),
        sloped_sigma_m2: rounded(sloped.sigma, 4),
        perimeter_m: rounded(perimeter.value, 4),
        perimeter_sigma_m: rounded(perimeter.sigma, 4),
      };
    }
    case "volume": {
      const { net, cut, fill } = measurement.result;
      return { ...main(net, "m3"), cut_m3: rounded(cut, 4), fill_m3: rounded(fill, 4), base: measurement.base };
    }
    default:
      return measurement satisfies never;
  }
}

function coordinates({ enu }: SurfacePoint, project: MeasuredProject): readonly (number | null)[] {
  if (!project.georeferenced) return enu.map((value) => rounded(value, 3));
  const map = mapFromEnu(project, enu);
  if (map !== null) return map.map((value) => rounded(value, 3));
  const place = geodeticFromEnu(project, enu);
  return [rounded(place.longitudeDeg, 9), rounded(place.latitudeDeg, 9), rounded(place.heightM, 3)];
}

function wkt({ kind, points }: Measurement, project: MeasuredProject): string {
  const texts = points.map((point) => coordinates(point, project).join(" "));
  if (kind === "point") return `POINT Z (${texts[0] ?? ""})`;
  if (kind === "distance" || kind === "profile") return `LINESTRING Z (${texts.join(", ")})`;
  return `POLYGON Z ((${[...texts, ...texts.slice(0, 1)].join(", ")}))`;
}

/** Distance along the profile, height in the survey's system (`offsetM` added to z of ENU), its deviation. Empty cells: no surface. */
export function profileCsv({ lengthM, heightsM, spreadsM }: ProfileMeasurement, offsetM: number): string {
  const last = Math.max(1, heightsM.length - 1);
  const rows = heightsM.map((height, i) => [
    rounded((lengthM * i) / last, 4),
    height === null ? null : rounded(height + offsetM, 4),
    rounded(spreadsM[i] ?? null, 4),
  ]);
  return csvText([["distance_m", "height_m", "sigma_m"], ...rows]);
}
