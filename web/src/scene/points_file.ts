// points.bin and contours.json (docs/viewer_protocol.md) as arrays for the graphics card.
import { asArray, asBoolean, asInteger, asNumber, asObject } from "../base/check.js";
import type { Vec3 } from "../base/vec.js";
import type { ProjectBase } from "../state/project.js";

const HEAD_BYTES = 8 + 2 * 4 + 3 * 8;
const MOST_POINTS = 1 << 25;

export interface PointsFile {
  /** What was subtracted from the points, in the project's own ENU. */
  readonly anchor: Vec3;
  readonly positions: Float32Array;
  readonly colours: Uint8Array;
}

export function parsePoints(bytes: ArrayBuffer): PointsFile {
  const magic = String.fromCharCode(...new Uint8Array(bytes, 0, Math.min(8, bytes.byteLength)));
  if (bytes.byteLength < HEAD_BYTES || magic !== "SKYPNTS1")
    throw new Error("the points are damaged: they do not begin with SKYPNTS1");
  const view = new DataView(bytes);
  const count = view.getUint32(8, true);
  const anchor: Vec3 = [view.getFloat64(16, true), view.getFloat64(24, true), view.getFloat64(32, true)];
  if (count > MOST_POINTS || bytes.byteLength !== HEAD_BYTES + 15 * count || !anchor.every(Number.isFinite)) {
    throw new Error(`the points are damaged: ${count} do not fit ${bytes.byteLength} bytes`);
  }
  const positions = new Float32Array(bytes, HEAD_BYTES, 3 * count);
  return { anchor, positions, colours: new Uint8Array(bytes, HEAD_BYTES + 12 * count, 3 * count) };
}

export interface ContourLines {
  /** Two points per piece, relative to the anchor. */
  readonly plain: Float32Array;
  /** Every fifth line. */
  readonly index: Float32Array;
}

const EARTH_RADIUS_M = 6371000;

/** Lines as pieces, ENU minus `anchor`. Heights above the ellipsoid become z of ENU, from which the Earth curves away. */
export function parseContours(value: unknown, project: ProjectBase, anchor: Vec3): ContourLines {
  const plain: number[] = [];
  const index: number[] = [];
  const lines = asArray(asObject(value, "contours").lines, "contours.lines");
  for (const [i, entry] of lines.entries()) {
    const path = `contours.lines[${i}]`;
    const line = asObject(entry, path);
    const height = asNumber(line.height_m, `${path}.height_m`);
    const points = asArray(line.points, `${path}.points`);
    const target = isIndex(line.index, `${path}.index`) ? index : plain;
    let previous: Vec3 | null = null;
    for (let k = 0; k + 1 < points.length; k += 2) {
      const x = asNumber(points[k], `${path}.points[${k}]`);
      const y = asNumber(points[k + 1], `${path}.points[${k + 1}]`);
      const z = project.georeferenced
        ? height - project.origin.heightM - (x * x + y * y) / (2 * EARTH_RADIUS_M)
        : height;
      const point: Vec3 = [x - anchor[0], y - anchor[1], z - anchor[2]];
      if (previous !== null) target.push(...previous, ...point);
      previous = point;
    }
  }
  return { plain: Float32Array.from(plain), index: Float32Array.from(index) };
}

/** 0 and 1, as in the GeoPackage, or false and true. */
function isIndex(value: unknown, path: string): boolean {
  if (value === undefined || value === null) return false;
  return typeof value === "number" ? asInteger(value, path) !== 0 : asBoolean(value, path);
}
