// Results of measurements as lines of text, for the panel and the clipboard.
import { geodeticFromEnu } from "../../geo/earth.js";
import { formatArea, formatEstimate, formatLatLon, formatLength, formatMap, formatVolume } from "../../geo/format.js";
import { outlineOffsetM } from "../../geo/heights.js";
import { knowsGeoReference, pointSigma } from "../../geo/measure.js";
import { mapFromEnu } from "../../geo/projection.js";
import type { Measurement, SurfacePoint, Survey } from "../../state/app_state.js";
import { middleOf } from "../../state/measurements_file.js";
import type { Project } from "../../state/project.js";
import { BASE_LABELS, levelSigmaM, measuredSurvey } from "../../state/volumes.js";

export interface ResultLine {
  readonly label: string;
  readonly text: string;
}

export function resultLines(measurement: Measurement, project: Project): readonly ResultLine[] {
  switch (measurement.kind) {
    case "point": {
      const point = measurement.points[0];
      return point === undefined ? [] : pointLines(point, project);
    }
    case "distance": {
      const { slope, plan, rise } = measurement.result;
      return [
        { label: "Distance", text: formatEstimate(slope) },
        { label: "In plan", text: formatEstimate(plan) },
        { label: "Height difference", text: formatEstimate(rise) },
      ];
    }
    case "profile":
      return [...profileLines(measurement.lengthM, measurement.heightsM), ...surveyLines(measurement.survey, project)];
    case "area": {
      const { plan, sloped, perimeter } = measurement.result;
      return [
        { label: "Area in plan", text: formatEstimate(plan, "area") },
        { label: "Area on its plane", text: formatEstimate(sloped, "area") },
        { label: "Perimeter", text: formatEstimate(perimeter) },
      ];
    }
    case "volume": {
      const { net, cut, fill, surfaceArea, filled, cellM } = measurement.result;
      return [
        { label: "Net", text: formatEstimate(net, "volume") },
        { label: "Above the base", text: formatVolume(cut) },
        { label: "Below the base", text: formatVolume(fill) },
        { label: "Base", text: baseText(measurement, project) },
        { label: "Surface", text: formatArea(surfaceArea) },
        { label: "Grid", text: `${formatLength(cellM)} cells, ${(100 * filled).toFixed(0)} % with a surface` },
        ...surveyLines(measuredSurvey(measurement), project),
      ];
    }
    default:
      return measurement satisfies never;
  }
}

/** Only what is on the earlier survey says so. */
function surveyLines(survey: Survey, project: Project): readonly ResultLine[] {
  return survey === "main" ? [] : [{ label: "Survey", text: project.before?.name ?? "the earlier one" }];
}

function baseText(measurement: Extract<Measurement, { kind: "volume" }>, project: Project): string {
  const { base, baseHeightM, points } = measurement;
  if (base !== "height" || baseHeightM === null) return BASE_LABELS[base];
  return `level at ${(baseHeightM + outlineOffsetM(project, points)).toFixed(2)} m`;
}

function pointLines(point: SurfacePoint, project: Project): readonly ResultLine[] {
  const sigma = pointSigma(point, project.accuracy, middleOf(project));
  const map = project.georeferenced ? mapFromEnu(project, point.enu) : null;
  const spread = {
    label: "Position ±",
    text: sigma.horizontalM === null ? "unknown" : formatLength(sigma.horizontalM),
  };
  if (!project.georeferenced) {
    const [x, y, z] = point.enu;
    return [
      { label: "x, y", text: `${x.toFixed(3)}, ${y.toFixed(3)}` },
      { label: "z", text: formatEstimate({ value: z, sigma: sigma.verticalM }) },
      spread,
    ];
  }
  const place = geodeticFromEnu(project, point.enu);
  return [
    ...(map === null ? [] : [{ label: "Easting, northing", text: formatMap(map) }]),
    { label: "Latitude, longitude", text: formatLatLon(place.latitudeDeg, place.longitudeDeg) },
    { label: "Height", text: `${heightText(place.heightM, sigma.verticalM)}` },
    spread,
  ];
}

/** Heights keep their centimetres, also where ± is metres. */
function heightText(m: number, sigma: number | null): string {
  if (sigma === null) return `${m.toFixed(2)} m`;
  return `${m.toFixed(2)} m ± ${sigma < 0.01 ? "<0.01" : sigma.toFixed(2)} m`;
}

function profileLines(lengthM: number, heightsM: readonly (number | null)[]): readonly ResultLine[] {
  const known = heightsM.filter((height): height is number => height !== null);
  const low = known.reduce((least, height) => Math.min(least, height), Number.POSITIVE_INFINITY);
  const high = known.reduce((most, height) => Math.max(most, height), Number.NEGATIVE_INFINITY);
  return [
    { label: "Length in plan", text: formatLength(lengthM) },
    { label: "Lowest to highest", text: known.length === 0 ? "no surface" : formatLength(high - low) },
  ];
}

/** What the deviations of this measurement do not contain; empty: nothing. */
export function deviationNote(measurement: Measurement, project: Project): string {
  if (measurement.kind !== "profile" && measurement.points.some(({ spreadM }) => spreadM === null)) {
    return "Without ±: not all points are confirmed by the field.";
  }
  const notes: string[] = [];
  if (!knowsGeoReference(project.accuracy)) notes.push("± without the geo-reference's share, which is unknown.");
  if (measurement.kind === "volume" && levelSigmaM(project, measurement) === null) {
    notes.push("± without the vertical accuracy, which is unknown.");
  }
  return notes.join(" ");
}

/** For the clipboard. */
export function measurementText(measurement: Measurement, project: Project): string {
  return [measurement.name, ...resultLines(measurement, project).map(({ label, text }) => `${label}: ${text}`)].join(
    "\n",
  );
}
