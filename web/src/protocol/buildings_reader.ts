// buildings.json (docs/files.md) as a BuildingSet. What is wrong is named with its place in the file.
import {
  asArray,
  asBoolean,
  asChoice,
  asInteger,
  asList,
  asNumber,
  asObject,
  asString,
  CheckError,
  member,
  optional,
} from "../base/check.js";
import type { Vec3 } from "../base/vec.js";
import type { Estimate } from "../geo/measure.js";
import {
  type Building,
  type BuildingSet,
  FACE_KINDS,
  type Face,
  MEASURE_NAMES,
  type MeasureName,
  ROOF_KINDS,
  type Solid,
} from "../state/buildings.js";

const FORMAT = "skyquilt buildings";
const VERSION = 1;
const MAX_BUILDINGS = 100_000;
/** Of one solid: the largest real ones have some hundreds. */
const MAX_PARTS = 20_000;
/** Metres from the origin: further away is no survey, and its squares could overflow. */
const FARTHEST = 1e7;
/** Of volumes, in cubic metres. */
const LARGEST = 1e12;

/** Names in the file. */
const MEASURES: Readonly<Record<MeasureName, string>> = {
  ground: "ground_m",
  eave: "eave_m",
  ridge: "ridge_m",
  height: "height_m",
  length: "length_m",
  width: "width_m",
  yaw: "yaw_deg",
  area: "footprint_m2",
  roofArea: "roof_m2",
  volume: "volume_m3",
  pitch: "pitch_deg",
};

function readMeasure(value: unknown, path: string): Estimate | null {
  const pair = asArray(value, path);
  if (pair.length !== 2)
    throw new CheckError(path, `a value and its deviation expected, found a list of ${pair.length}`);
  const number = optional(pair[0], `${path}[0]`, (given, at) => asNumber(given, at, -LARGEST, LARGEST));
  const sigma = optional(pair[1], `${path}[1]`, (given, at) => asNumber(given, at, 0, LARGEST));
  return number === null ? null : { value: number, sigma };
}

function readMeasures(value: unknown, path: string): Building["measures"] {
  const o = asObject(value, path);
  const read = (name: MeasureName) => readMeasure(o[MEASURES[name]], member(path, MEASURES[name]));
  return Object.fromEntries(MEASURE_NAMES.map((name) => [name, read(name)])) as Record<MeasureName, Estimate | null>;
}

function readVertex(value: unknown, path: string): Vec3 {
  const list = asArray(value, path);
  if (list.length !== 3) throw new CheckError(path, `3 numbers expected, found a list of ${list.length}`);
  const at = (axis: 0 | 1 | 2) => asNumber(list[axis], `${path}[${axis}]`, -FARTHEST, FARTHEST);
  return [at(0), at(1), at(2)];
}

function readRing(value: unknown, path: string, vertices: number): number[] {
  const ring = asList(value, path, (entry, at) => asInteger(entry, at, 0, vertices - 1), MAX_PARTS);
  if (ring.length < 3) throw new CheckError(path, `at least 3 corners expected, found ${ring.length}`);
  return ring;
}

function readFace(value: unknown, path: string, vertices: number): Face {
  const o = asObject(value, path);
  const ring = (given: unknown, at: string) => readRing(given, at, vertices);
  return {
    kind: asChoice(o.kind, member(path, "kind"), FACE_KINDS),
    rings: [ring(o.outer, member(path, "outer")), ...asList(o.holes, member(path, "holes"), ring, MAX_PARTS)],
  };
}

function readSolid(value: unknown, path: string): Solid {
  const o = asObject(value, path);
  const vertices = asList(o.vertex, member(path, "vertex"), readVertex, MAX_PARTS);
  const face = (given: unknown, at: string) => readFace(given, at, vertices.length);
  const faces = asList(o.face, member(path, "face"), face, MAX_PARTS);
  if (faces.length === 0) throw new CheckError(member(path, "face"), "it is empty");
  return { vertices, faces };
}

function readShare(value: unknown, path: string): number | null {
  // A share of areas may be a rounding above 1.
  const share = optional(value, path, (given, at) => asNumber(given, at, 0, 1.001));
  return share === null ? null : Math.min(1, share);
}

function readBuilding(value: unknown, path: string): Building {
  const o = asObject(value, path);
  const at = (key: string) => member(path, key);
  const measures = asObject(o.measures, at("measures"));
  return {
    id: asInteger(o.id, at("id"), 1),
    roof: asChoice(o.roof, at("roof"), ROOF_KINDS),
    accepted: asBoolean(o.accepted, at("accepted")),
    note: asString(o.note, at("note"), 5000),
    givenId: asString(o.given_id, at("given_id"), 5000),
    measures: readMeasures(measures, at("measures")),
    wallSeen: readShare(measures.wall_seen, member(at("measures"), "wall_seen")),
    shareWithin: readShare(o.share_within, at("share_within")),
    roofPoints: asInteger(o.roof_points, at("roof_points"), 0),
    solid: readSolid(o.lod22, at("lod22")),
  };
}

/** Throws a CheckError that names the member. */
export function readBuildings(value: unknown): BuildingSet {
  const o = asObject(value, "buildings.json");
  asChoice(o.format, "format", [FORMAT]);
  asInteger(o.version, "version", VERSION, VERSION);
  const buildings = asList(o.buildings, "buildings", readBuilding, MAX_BUILDINGS);
  const ids = new Set<number>();
  for (const [i, { id }] of buildings.entries()) {
    if (ids.has(id)) throw new CheckError(`buildings[${i}].id`, `${id} is there twice`);
    ids.add(id);
  }
  return {
    metric: asBoolean(o.metric, "metric"),
    scaleSource: asString(o.scale_source, "scale_source", 200),
    buildings,
  };
}
