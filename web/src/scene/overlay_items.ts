// What is drawn over the 3-D view as marks, lines and texts, from the state: places in ENU, nothing of the screen. Pure.
import type { Vec3 } from "../base/vec.js";
import { add, scale } from "../base/vec_math.js";
import { forward } from "../geo/camera.js";
import { formatArea, formatEstimate, formatLength, formatWithSuffix } from "../geo/format.js";
import { enuFromMap } from "../geo/projection.js";
import type { AppState, Enu, Measurement, SurfacePoint } from "../state/app_state.js";
import { findBuilding, topOfBuilding } from "../state/buildings.js";
import type { Project } from "../state/project.js";

export type OverlayStyle = "measure" | "selected" | "draft" | "control" | "path" | "block" | "building" | "photo";
export type OverlayItem =
  | { readonly kind: "line"; readonly style: OverlayStyle; readonly points: readonly Enu[]; readonly closed: boolean }
  | { readonly kind: "dot" | "cross"; readonly style: OverlayStyle; readonly point: Enu }
  | { readonly kind: "label"; readonly style: OverlayStyle; readonly point: Enu; readonly text: string };

const LONGEST_LABEL = 60;

function label(style: OverlayStyle, point: Enu, text: string): OverlayItem {
  const short = text.length > LONGEST_LABEL ? `${text.slice(0, LONGEST_LABEL - 1)}…` : text;
  return { kind: "label", style, point, text: short };
}

function middleOf(points: readonly Enu[]): Enu {
  const sum = points.reduce<Vec3>((total, point) => add(total, point), [0, 0, 0]);
  return scale(sum, 1 / Math.max(1, points.length));
}

/** The place half way along a line. */
function halfWay(points: readonly Enu[]): Enu {
  const lengths = points.slice(1).map((point, i) => {
    const before = points[i] ?? point;
    return Math.hypot(point[0] - before[0], point[1] - before[1], point[2] - before[2]);
  });
  let left = lengths.reduce((sum, length) => sum + length, 0) / 2;
  for (const [i, length] of lengths.entries()) {
    const [a, b] = [points[i], points[i + 1]];
    if (a !== undefined && b !== undefined && length > 0 && left <= length) {
      const u = left / length;
      return [a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1]), a[2] + u * (b[2] - a[2])];
    }
    left -= length;
  }
  return middleOf(points);
}

function valueText(measurement: Measurement): string {
  switch (measurement.kind) {
    case "point":
      return "";
    case "distance":
      return formatEstimate(measurement.result.slope, "length");
    case "profile":
      return formatLength(measurement.lengthM);
    case "area":
      return formatEstimate(measurement.result.plan, "area");
    case "volume":
      return formatEstimate(measurement.result.net, "volume");
    default: {
      const never: never = measurement;
      throw new Error(`unknown measurement ${String(never)}`);
    }
  }
}

function measurementItems(measurement: Measurement, selected: boolean): OverlayItem[] {
  const style = selected ? "selected" : "measure";
  const points = measurement.points.map((point) => point.enu);
  const first = points[0];
  if (first === undefined) return [];
  const closed = measurement.kind === "area" || measurement.kind === "volume";
  const text = [measurement.name, valueText(measurement)].filter((part) => part !== "").join(": ");
  const items: OverlayItem[] = points.length > 1 ? [{ kind: "line", style, points, closed }] : [];
  for (const point of points) items.push({ kind: "dot", style, point });
  items.push(label(style, closed ? middleOf(points) : points.length > 1 ? halfWay(points) : first, text));
  return items;
}

function planAreaM2(points: readonly Enu[]): number {
  let twice = 0;
  for (const [i, a] of points.entries()) {
    const b = points[(i + 1) % points.length] ?? a;
    twice += a[0] * b[1] - b[0] * a[1];
  }
  return Math.abs(twice) / 2;
}

function draftItems(state: AppState): OverlayItem[] {
  const { tool } = state;
  if (tool === "navigate") return [];
  const withHover: readonly SurfacePoint[] = state.hover === null ? state.draft : [...state.draft, state.hover];
  const points = withHover.map((point) => point.enu);
  const items: OverlayItem[] = [];
  const closed = (tool === "area" || tool === "volume") && points.length > 2;
  const drawsLine = tool === "distance" || tool === "profile" || tool === "area" || tool === "volume";
  const last = points[points.length - 1];
  if (drawsLine && points.length > 1 && last !== undefined) {
    items.push({ kind: "line", style: "draft", points, closed });
    const length = points.slice(1).reduce((sum, point, i) => {
      const before = points[i] ?? point;
      return sum + Math.hypot(point[0] - before[0], point[1] - before[1], point[2] - before[2]);
    }, 0);
    items.push(label("draft", last, closed ? formatArea(planAreaM2(points)) : formatLength(length)));
  }
  for (const point of state.draft) items.push({ kind: "dot", style: "draft", point: point.enu });
  if (state.hover !== null) items.push({ kind: "cross", style: "draft", point: state.hover.enu });
  return items;
}

function controlItems(project: Project, state: AppState): OverlayItem[] {
  return state.documents.controlPoints.flatMap((control) => {
    // Without geo-reference the file has local metres.
    const point = project.crs === null ? control.xyz : enuFromMap(project, control.xyz);
    if (point === null || !point.every(Number.isFinite)) return [];
    const style = control.name === state.selectedControl ? "selected" : "control";
    return [{ kind: "cross", style, point } as const, label(style, point, control.name)];
  });
}

/** `viewM`: length of the strokes that say where a key frame looks. */
function pathItems(state: AppState, viewM: number): OverlayItem[] {
  const { keys } = state.documents.cameraPath;
  const eyes = keys.map((key) => key.pose.eyeEnu);
  const items: OverlayItem[] = eyes.length > 1 ? [{ kind: "line", style: "path", points: eyes, closed: false }] : [];
  for (const [i, key] of keys.entries()) {
    const { eyeEnu, rotation } = key.pose;
    const ahead = add(eyeEnu, scale(forward(rotation), viewM));
    items.push({ kind: "line", style: "path", points: [eyeEnu, ahead], closed: false });
    items.push({ kind: "dot", style: "path", point: eyeEnu });
    items.push(label("path", eyeEnu, key.name === "" ? String(i + 1) : key.name));
  }
  return items;
}

/** The height of the chosen building and of the one under the pointer. */
function buildingItems({ buildings, selectedBuilding, hoverBuilding, clip }: AppState): OverlayItem[] {
  const { set } = buildings;
  if (set === null) return [];
  return [...new Set([selectedBuilding, hoverBuilding])].flatMap((id) => {
    const building = findBuilding(set, id);
    if (building === null) return [];
    const point = topOfBuilding(building);
    if (clip.on && point.some((value, i) => value < (clip.min[i] ?? 0) || value > (clip.max[i] ?? 0))) return [];
    const { height } = building.measures;
    const text = height === null ? "" : `: ${set.metric ? formatEstimate(height) : formatWithSuffix(height)}`;
    return [label(id === selectedBuilding ? "selected" : "building", point, `Building ${building.id}${text}`)];
  });
}

export function overlayItems(project: Project, state: AppState, sizeM: number): OverlayItem[] {
  const { layers, documents, shownMeasurements } = state;
  const items: OverlayItem[] = [];
  if (layers.blocks) {
    for (const block of project.blocks) {
      const middle = middleOf([block.min, block.max]);
      items.push(label("block", [middle[0], middle[1], block.max[2]], block.name));
    }
  }
  if (layers.buildings) items.push(...buildingItems(state));
  if (layers.cameraPath) items.push(...pathItems(state, sizeM / 40));
  if (layers.controlPoints) items.push(...controlItems(project, state));
  if (layers.measurements) {
    for (const measurement of documents.measurements) {
      if (shownMeasurements !== null && !shownMeasurements.includes(measurement.id)) continue;
      items.push(...measurementItems(measurement, measurement.id === state.selected));
    }
  }
  if (state.sights !== null) items.push({ kind: "cross", style: "photo", point: state.sights.point.enu });
  items.push(...draftItems(state));
  return items;
}

/** Members of the state on which the items depend: another array only when one of them is another one. */
export function overlayInputs(state: AppState): readonly unknown[] {
  const { layers, documents, selected, selectedControl, draft, hover, tool, sights } = state;
  const { buildings, selectedBuilding, hoverBuilding, clip, shownMeasurements } = state;
  return [
    layers,
    documents,
    selected,
    selectedControl,
    draft,
    hover,
    tool,
    sights,
    buildings,
    selectedBuilding,
    hoverBuilding,
    clip,
    shownMeasurements,
  ];
}
