// What the status bar says, as pure functions.

import { geodeticFromEnu } from "../../geo/earth.js";
import { formatLatLon } from "../../geo/format.js";
import { mapFromEnu } from "../../geo/projection.js";
import type { AppState, EngineStatus, SurfacePoint } from "../../state/app_state.js";
import type { ProjectBase } from "../../state/project.js";

export interface CursorText {
  readonly first: string;
  readonly second: string;
  readonly height: string;
  /** Longitude and latitude; empty without geo-reference. */
  readonly latLon: string;
  /** Where it comes from and ±. */
  readonly source: string;
}

type PositionProject = Pick<ProjectBase, "georeferenced" | "crs" | "origin">;

export function cursorText(project: PositionProject, point: SurfacePoint): CursorText {
  const spread = point.spreadM === null || !Number.isFinite(point.spreadM) ? "" : ` ± ${spreadText(point.spreadM)}`;
  const source = `${point.source === "field" ? "field" : "mesh"}${spread}`;
  const map = project.georeferenced ? mapFromEnu(project, point.enu) : null;
  if (map === null) {
    const [x, y, z] = point.enu;
    return { first: `x ${fixed(x)}`, second: `y ${fixed(y)}`, height: `z ${fixed(z)} m`, latLon: "", source };
  }
  const place = geodeticFromEnu(project, point.enu);
  return {
    first: `E ${fixed(map[0])}`,
    second: `N ${fixed(map[1])}`,
    height: `H ${fixed(map[2])} m`,
    latLon: formatLatLon(place.latitudeDeg, place.longitudeDeg),
    source,
  };
}

/** Centimetres are what such surveys can tell. */
function fixed(value: number): string {
  return Number.isFinite(value) ? value.toFixed(2) : "–";
}

function spreadText(m: number): string {
  return m < 0.1 ? `${(m * 100).toFixed(1)} cm` : `${m.toFixed(2)} m`;
}

export interface EngineText {
  readonly kind: "lost" | "off" | "waiting" | "working" | "exact";
  readonly text: string;
  readonly title: string;
}

export function engineText(engine: EngineStatus, layers: AppState["layers"]): EngineText {
  if (!engine.connected)
    return { kind: "lost", text: "Connection lost", title: "Trying again. Is skyquilt view still running?" };
  if (!engine.ready) return { kind: "off", text: "No exact frames", title: engine.reason };
  if (!layers.exact) return { kind: "off", text: "Exact frames off", title: "Switch them on in the layers panel." };
  if (engine.pass < 0) return { kind: "waiting", text: "Surface", title: "The exact frame comes when the view rests." };
  if (engine.pass < engine.passes - 1) {
    return { kind: "working", text: "Refining", title: `Pass ${engine.pass + 1} of ${engine.passes} is shown.` };
  }
  return { kind: "exact", text: "Exact", title: `The field itself, exposure ${engine.exposure}.` };
}
