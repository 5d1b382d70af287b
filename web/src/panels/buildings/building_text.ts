// Buildings as rows of text: the card of one, the table of all, and what the clipboard gets.
import { formatEstimate, formatMap, formatWithSuffix, shortVertical, type UnitKind } from "../../geo/format.js";
import { mapFromEnu } from "../../geo/projection.js";
import { type Building, type BuildingSet, type MeasureName, measureOf, topOfBuilding } from "../../state/buildings.js";
import type { Project } from "../../state/project.js";

export const ROOF_LABELS = { flat: "flat", gable: "gable", hip: "hip", other: "other" } as const;

export interface BuildingLine {
  readonly label: string;
  readonly text: string;
}

const UNKNOWN = "unknown";

type Place = Pick<Project, "georeferenced" | "origin" | "crs" | "vertical">;

function measureText(
  building: Building,
  name: MeasureName,
  kind: UnitKind | "angle",
  set: BuildingSet,
  project: Place,
) {
  const measure = measureOf(building, name, project);
  if (measure === null) return UNKNOWN;
  if (kind === "angle") return formatWithSuffix(measure, "°");
  return set.metric ? formatEstimate(measure, kind) : formatWithSuffix(measure);
}

/** All measures with one standard deviation. */
export function buildingLines(building: Building, set: BuildingSet, project: Place): readonly BuildingLine[] {
  const line = (label: string, name: MeasureName, kind: UnitKind | "angle" = "length"): BuildingLine => ({
    label,
    text: measureText(building, name, kind, set, project),
  });
  const pitched = building.roof === "gable" || building.roof === "hip";
  return [
    line("Height", "height"),
    line("Length", "length"),
    line("Width", "width"),
    line("Footprint", "area", "area"),
    line("Volume", "volume", "volume"),
    line("Ground", "ground"),
    ...(pitched ? [line("Eave", "eave"), line("Ridge", "ridge")] : [line("Roof", "ridge")]),
    line("Roof area", "roofArea", "area"),
    ...(pitched ? [line("Roof pitch", "pitch", "angle")] : []),
    line("Direction", "yaw", "angle"),
    { label: "Walls seen", text: percent(building.wallSeen) },
    { label: "Roof fits", text: fitText(building) },
    ...placeLines(building, project),
    ...(building.givenId === "" ? [] : [{ label: "Given outline", text: building.givenId }]),
  ];
}

function percent(share: number | null): string {
  return share === null ? UNKNOWN : `${Math.round(100 * share)} %`;
}

function fitText({ shareWithin, roofPoints }: Building): string {
  return shareWithin === null ? UNKNOWN : `${percent(shareWithin)} of ${roofPoints.toLocaleString("en")} points`;
}

function placeLines(building: Building, project: Place): readonly BuildingLine[] {
  const top = topOfBuilding(building);
  const map = project.georeferenced ? mapFromEnu(project, top) : null;
  if (map === null) return [{ label: "x, y", text: `${top[0].toFixed(2)}, ${top[1].toFixed(2)}` }];
  return [{ label: "Middle", text: formatMap(map) }];
}

/** How the numbers are meant. */
export function measuresNote(set: BuildingSet, project: Place): string {
  const spread = "± is one standard deviation. The direction of the length is counter-clockwise from east.";
  if (!set.metric)
    return `${spread} The scale is not known, so lengths have no unit: give two points with --scale-bar.`;
  if (!project.georeferenced) return `${spread} Scale: ${set.scaleSource}. Heights are those of the local frame.`;
  return `${spread} Ground, eave and ridge are heights above ${shortVertical(project.vertical)}.`;
}

/** For the clipboard. */
export function buildingText(building: Building, set: BuildingSet, project: Place): string {
  return [
    `Building ${building.id}`,
    ...[
      { label: "Type of roof", text: ROOF_LABELS[building.roof] },
      { label: "Model fits the points", text: building.accepted ? "yes" : "no" },
      ...buildingLines(building, set, project),
      ...(building.note === "" ? [] : [{ label: "Note", text: building.note }]),
    ].map(({ label, text }) => `${label}: ${text}`),
    measuresNote(set, project),
  ].join("\n");
}

export const SORT_KEYS = ["id", "height", "length", "width", "area", "roof", "accepted"] as const;
export type SortKey = (typeof SORT_KEYS)[number];
export interface SortOrder {
  readonly key: SortKey;
  readonly descending: boolean;
}

/** Null: unknown, which comes last either way. */
function sortValue(building: Building, key: SortKey): number | string | null {
  switch (key) {
    case "id":
      return building.id;
    case "roof":
      return building.roof;
    case "accepted":
      return building.accepted ? 0 : 1;
    default:
      return building.measures[key]?.value ?? null;
  }
}

/** Equal ones by id. */
export function sortBuildings(buildings: readonly Building[], { key, descending }: SortOrder): readonly Building[] {
  const sign = descending ? -1 : 1;
  return buildings
    .map((building) => ({ building, value: sortValue(building, key) }))
    .sort((a, b) => {
      if (a.value !== b.value) {
        if (a.value === null) return 1;
        if (b.value === null) return -1;
        return a.value < b.value ? -sign : sign;
      }
      return a.building.id - b.building.id;
    })
    .map(({ building }) => building);
}

/** A click on a column: figures begin with the largest, the same column again turns round. */
export function nextOrder(order: SortOrder, key: SortKey): SortOrder {
  if (order.key === key) return { key, descending: !order.descending };
  return { key, descending: key !== "id" && key !== "roof" };
}

/** Names of files by what programs call them. */
export function fileLabel(url: string): string {
  const names = { csv: "CSV", "city.json": "CityJSON", gpkg: "GeoPackage", glb: "GLB", dxf: "DXF" } as const;
  const end = Object.entries(names).find(([ending]) => url.endsWith(`.${ending}`));
  return end?.[1] ?? url.slice(url.lastIndexOf("/") + 1);
}

/** "7.30": for a column whose head or caption says the unit. */
export function columnText(building: Building, name: "height" | "length" | "width" | "area"): string {
  const value = building.measures[name]?.value;
  if (value === undefined) return "–";
  const digits = name === "area" ? (value < 99.95 ? 1 : 0) : value < 99.995 ? 2 : 1;
  return value.toFixed(digits);
}
