// The table of buildings as CSV, with the names of columns that buildings.csv has.
import type { HeightProject } from "../geo/heights.js";
import { type Building, MEASURE_NAMES, type MeasureName, measureOf } from "./buildings.js";
import { csvText } from "./csv.js";

const COLUMNS: Readonly<Record<MeasureName, readonly [name: string, unit: string]>> = {
  ground: ["ground", "_m"],
  eave: ["eave", "_m"],
  ridge: ["ridge", "_m"],
  height: ["height", "_m"],
  length: ["length", "_m"],
  width: ["width", "_m"],
  yaw: ["yaw", "_deg"],
  area: ["area", "_m2"],
  roofArea: ["roof_area", "_m2"],
  volume: ["volume", "_m3"],
  pitch: ["pitch", "_deg"],
};

/** Angles have their unit always, lengths, areas and volumes only when it is known. */
function columnOf(name: MeasureName, metric: boolean): string {
  const [text, unit] = COLUMNS[name];
  return metric || unit === "_deg" ? `${text}${unit}` : text;
}

function rounded(value: number | null | undefined): number | null {
  return value === null || value === undefined || !Number.isFinite(value) ? null : Number(value.toFixed(4));
}

/** One row per building in the given order. */
export function buildingsCsv(buildings: readonly Building[], metric: boolean, project: HeightProject): string {
  const columns = MEASURE_NAMES.flatMap((name) => {
    const column = columnOf(name, metric);
    return [column, `${column}_sigma`];
  });
  const rows = buildings.map((building) => [
    building.id,
    ...MEASURE_NAMES.flatMap((name) => {
      const measure = measureOf(building, name, project);
      return [rounded(measure?.value), rounded(measure?.sigma)];
    }),
    rounded(building.wallSeen),
    building.roof,
    building.accepted ? 1 : 0,
    building.note,
  ]);
  return csvText([["id", ...columns, "wall_seen", "roof", "accepted", "note"], ...rows]);
}
