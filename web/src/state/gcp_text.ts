// Reads OpenDroneMap's gcp_list.txt: the coordinate system in the first line, then `x y z pixel_x pixel_y photo [name]` per mark. Coordinates in
// another system than the project's are converted; heights are taken as they are.
import type { Vec2, Vec3 } from "../base/vec.js";
import { geodeticFromMap, mapFromGeodetic } from "../geo/projection.js";
import type { ControlMark, ControlPoint } from "./app_state.js";
import { usableName } from "./names.js";
import type { Crs, Photo } from "./project.js";

export interface GcpList {
  readonly points: readonly ControlPoint[];
  /** What was left out or assumed, one sentence each. */
  readonly problems: readonly string[];
}

interface GcpProject {
  readonly crs: Crs | null;
  readonly photos: readonly Pick<Photo, "name">[];
}

type Header =
  | { readonly kind: "local" }
  | { readonly kind: "geographic" }
  | { readonly kind: "map"; readonly crs: Crs; readonly etrs89: boolean };

interface Row {
  readonly xyz: Vec3;
  readonly pixel: Vec2;
  readonly photo: string;
  readonly name: string | null;
}

const MOST_POINTS = 1000;
const MOST_PROBLEMS = 8;

/** `taken`: names of the points that are there already; points without a name get others. Throws an Error for the user when nothing can be used. */
export function readGcpList(text: string, project: GcpProject, taken: readonly string[] = []): GcpList {
  const lines = text.replace(/^\uFEFF/, "").split(/\r\n|\r|\n/);
  const first = lines.findIndex((line) => line.trim() !== "" && !line.trim().startsWith("#"));
  if (first < 0)
    throw new Error("The file is empty. Its first line must name the coordinate system, such as EPSG:32632.");
  const header = readHeader((lines[first] ?? "").trim());
  const convert = converter(header, project.crs);
  const problems: string[] = [];
  if (header.kind === "map" && header.etrs89)
    problems.push("ETRS89 coordinates were taken as WGS84 (less than 1 m apart).");
  const photoNamed = photoFinder(project.photos);
  const points = new Map<string, { name: string | null; xyz: Vec3; marks: ControlMark[] }>();
  const unknownPhotos = new Set<string>();
  for (const [index, line] of lines.entries()) {
    const content = line.trim();
    if (index <= first || content === "" || content.startsWith("#")) continue;
    const row = readRow(content);
    const xyz = row === null ? null : convert(row.xyz);
    if (row === null || xyz === null) {
      problems.push(`Line ${index + 1} was left out: it needs x y z pixel_x pixel_y photo [name].`);
      continue;
    }
    const key = row.name ?? row.xyz.join(" ");
    const point = points.get(key) ?? { name: row.name, xyz, marks: [] };
    if (!points.has(key) && points.size >= MOST_POINTS)
      throw new Error(`The file has more than ${MOST_POINTS} points.`);
    points.set(key, point);
    const photo = photoNamed(row.photo);
    if (photo === null) unknownPhotos.add(row.photo);
    else point.marks = [...point.marks.filter((mark) => mark.photo !== photo), { photo, pixel: row.pixel }];
  }
  if (unknownPhotos.size > 0) {
    const examples = [...unknownPhotos].slice(0, 3).join(", ");
    problems.push(`${unknownPhotos.size} photos are not in this project, their marks were left out: ${examples}.`);
  }
  if (points.size === 0) throw new Error(problems[0] ?? "The file has a coordinate system but no points.");
  return { points: named([...points.values()], taken), problems: shortened(problems) };
}

/** Points of the same name get the loaded coordinates; marks in the same photo are replaced, the others stay. */
export function mergeControlPoints(
  existing: readonly ControlPoint[],
  loaded: readonly ControlPoint[],
): readonly ControlPoint[] {
  const merged = new Map(existing.map((point) => [point.name, point]));
  for (const point of loaded) {
    const old = merged.get(point.name);
    const kept = (old?.marks ?? []).filter((mark) => !point.marks.some((other) => other.photo === mark.photo));
    merged.set(point.name, { ...point, marks: [...kept, ...point.marks] });
  }
  return [...merged.values()];
}

function readHeader(line: string): Header {
  const text = line.toUpperCase();
  if (text === "LOCAL") return { kind: "local" };
  const epsg = /^EPSG:\s*(\d+)$/.exec(text);
  if (epsg !== null) return headerOfEpsg(Number(epsg[1]), line);
  if (/\+PROJ=(LONGLAT|LATLONG)\b/.test(text) || text === "WGS84") return { kind: "geographic" };
  const utm = /^WGS84 UTM (\d{1,2}) ?([NS])$/.exec(text);
  if (utm !== null) return mapHeader(Number(utm[1]), utm[2] === "N", false, line);
  const zone = /\+ZONE=(\d{1,2})\b/.exec(text);
  if (/\+PROJ=UTM\b/.test(text) && zone !== null)
    return mapHeader(Number(zone[1]), !/\+SOUTH\b/.test(text), false, line);
  throw unknownSystem(line);
}

function headerOfEpsg(code: number, line: string): Header {
  if (code === 4326 || code === 4979) return { kind: "geographic" };
  if (code === 32661 || code === 32761)
    return { kind: "map", crs: { name: `EPSG:${code}`, zone: 0, north: code === 32661 }, etrs89: false };
  if (code > 32600 && code <= 32660) return mapHeader(code - 32600, true, false, line);
  if (code > 32700 && code <= 32760) return mapHeader(code - 32700, false, false, line);
  if (code >= 25828 && code <= 25838) return mapHeader(code - 25800, true, true, line);
  throw unknownSystem(line);
}

function mapHeader(zone: number, north: boolean, etrs89: boolean, line: string): Header {
  if (zone < 1 || zone > 60) throw unknownSystem(line);
  const code = (north ? 32600 : 32700) + zone;
  return { kind: "map", crs: { name: `EPSG:${code}`, zone, north }, etrs89 };
}

function unknownSystem(line: string): Error {
  return new Error(
    `The coordinate system "${line.slice(0, 80)}" is not known. Use WGS84 in longitude and latitude (EPSG:4326) or in UTM (EPSG:32601 to 32760).`,
  );
}

/** Coordinates of the file to those of the project; null: outside what can be converted. */
function converter(header: Header, crs: Crs | null): (xyz: Vec3) => Vec3 | null {
  if (crs === null) {
    if (header.kind === "local") return (xyz) => xyz;
    throw new Error(
      "The project has no geo-reference: its control points need local metres, and LOCAL in the file's first line.",
    );
  }
  if (header.kind === "local")
    throw new Error(`The file has local coordinates, the project needs those of ${crs.name}.`);
  if (header.kind === "map" && header.crs.zone === crs.zone && header.crs.north === crs.north) return (xyz) => xyz;
  return (xyz) => {
    const position =
      header.kind === "map"
        ? geodeticFromMap(header.crs, [xyz[0], xyz[1]])
        : { latitudeDeg: xyz[1], longitudeDeg: xyz[0] };
    if (!(Math.abs(position.latitudeDeg) <= 90) || !(Math.abs(position.longitudeDeg) <= 360)) return null;
    const [easting, northing] = mapFromGeodetic(crs, position.latitudeDeg, position.longitudeDeg);
    return Number.isFinite(easting) && Number.isFinite(northing) ? [easting, northing, xyz[2]] : null;
  };
}

function readRow(content: string): Row | null {
  const fields = content.split(/\s+/);
  const numbers = fields.slice(0, 5).map(readNumber);
  const [x, y, z, column, row] = numbers;
  const photo = fields[5];
  if (x == null || y == null || z == null || column == null || row == null || photo === undefined) return null;
  return { xyz: [x, y, z], pixel: [column, row], photo, name: usableName(fields[6] ?? "") };
}

function readNumber(text: string): number | null {
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text)) return null;
  const value = Number(text);
  return Number.isFinite(value) ? value : null;
}

/** By the whole name, else by the name without folders when only one photo has it. */
function photoFinder(photos: GcpProject["photos"]): (name: string) => string | null {
  const whole = new Set(photos.map((photo) => photo.name));
  const byBase = new Map<string, string | null>();
  for (const photo of photos) {
    const base = baseName(photo.name);
    byBase.set(base, byBase.has(base) ? null : photo.name);
  }
  return (name) => (whole.has(name) ? name : (byBase.get(baseName(name)) ?? null));
}

function baseName(path: string): string {
  return path.slice(Math.max(path.lastIndexOf("/"), path.lastIndexOf("\\")) + 1).toLowerCase();
}

function named(
  points: readonly { name: string | null; xyz: Vec3; marks: readonly ControlMark[] }[],
  existing: readonly string[],
): ControlPoint[] {
  const taken = new Set<string | null>([...existing, ...points.map((point) => point.name)]);
  return points.map(({ name, xyz, marks }) => {
    const own = name ?? freePointName(taken);
    taken.add(own);
    return { name: own, xyz, marks };
  });
}

/** "GCP_1", or the first number that is free. Names are words in gcp_list.txt: no spaces. */
export function freePointName(taken: Iterable<string | null>): string {
  const names = new Set(taken);
  for (let number = 1; ; number += 1) {
    if (!names.has(`GCP_${number}`)) return `GCP_${number}`;
  }
}

function shortened(problems: readonly string[]): readonly string[] {
  if (problems.length <= MOST_PROBLEMS) return problems;
  return [...problems.slice(0, MOST_PROBLEMS), `And ${problems.length - MOST_PROBLEMS} more lines of this kind.`];
}
