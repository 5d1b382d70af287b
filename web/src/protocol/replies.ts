// The server's texts (docs/viewer_protocol.md) as typed values. Members that we do not know are left alone, so that a newer server may say more.
import {
  asArray,
  asBoolean,
  asInteger,
  asList,
  asNumber,
  asObject,
  asString,
  asVec2,
  asVec3,
  CheckError,
  type JsonObject,
  optional,
  optionalNumber,
  parseJson,
} from "../base/check.js";
import type { Vec3 } from "../base/vec.js";
import type { DrapedMap, ErrorMap, PhotoSight } from "../state/app_state.js";

export interface EngineText {
  readonly ready: boolean;
  readonly reason: string;
  readonly revision: number;
  readonly exposure: string;
  readonly clients: number;
  readonly ranks: number;
}
export interface PickedText {
  readonly hit: boolean;
  readonly point: Vec3;
  readonly depthM: number;
  readonly spreadM: number | null;
  readonly opacity: number;
}
export interface PhotosText {
  readonly checked: boolean;
  readonly photos: readonly PhotoSight[];
}
export interface ProfileText {
  readonly lengthM: number;
  readonly heightsM: readonly (number | null)[];
  readonly spreadsM: readonly (number | null)[];
}
export interface VolumeText {
  readonly cellM: number;
  readonly cells: number;
  readonly filled: number;
  readonly planAreaM2: number;
  readonly surfaceAreaM2: number;
  readonly cutM3: number;
  readonly fillM3: number;
  readonly netM3: number;
  readonly sigmaM3: number | null;
  readonly baseMeanM: number;
}

export type ServerText =
  | { readonly type: "welcome"; readonly version: number; readonly engine: EngineText }
  | { readonly type: "engine"; readonly engine: EngineText }
  | { readonly type: "picked"; readonly id: number; readonly value: PickedText }
  | { readonly type: "photos"; readonly id: number; readonly value: PhotosText }
  | { readonly type: "profile"; readonly id: number; readonly value: ProfileText }
  | { readonly type: "volume"; readonly id: number; readonly value: VolumeText }
  | { readonly type: "error_map"; readonly id: number; readonly value: ErrorMap }
  | { readonly type: "trust_map"; readonly id: number; readonly value: DrapedMap }
  | { readonly type: "progress"; readonly id: number; readonly fraction: number }
  | { readonly type: "error"; readonly id: number | null; readonly message: string };

const U32 = 0xffffffff;

function readEngine(value: unknown, path: string): EngineText {
  const o = asObject(value, path);
  return {
    ready: asBoolean(o.ready, `${path}.ready`),
    reason: asString(o.reason, `${path}.reason`, 4000),
    revision: asInteger(o.revision, `${path}.revision`, 0, U32),
    exposure: asString(o.exposure, `${path}.exposure`, 1000),
    clients: asInteger(o.clients, `${path}.clients`, 0),
    ranks: asInteger(o.ranks, `${path}.ranks`, 0),
  };
}

function readPicked(o: JsonObject): PickedText {
  const hit = asBoolean(o.hit, "hit");
  // Without a hit there is no point: its numbers may be null.
  if (!hit) {
    return { hit, point: [0, 0, 0], depthM: 0, spreadM: null, opacity: optionalNumber(o.opacity, "opacity") ?? 0 };
  }
  return {
    hit,
    point: asVec3(o.point, "point"),
    depthM: asNumber(o.depth_m, "depth_m"),
    spreadM: optional(o.spread_m, "spread_m", (value, path) => asNumber(value, path, 0)),
    opacity: asNumber(o.opacity, "opacity"),
  };
}

function readSight(value: unknown, path: string): PhotoSight {
  const o = asObject(value, path);
  return {
    photo: asInteger(o.photo, `${path}.photo`, 0),
    pixel: asVec2(o.pixel, `${path}.pixel`),
    distanceM: asNumber(o.distance_m, `${path}.distance_m`),
    gsdM: asNumber(o.gsd_m, `${path}.gsd_m`),
    visible: asBoolean(o.visible, `${path}.visible`),
  };
}

function readProfile(o: JsonObject): ProfileText {
  const heightsM = asList(o.heights_m, "heights_m", optionalNumber, 4096);
  const spreadsM = asList(o.spreads_m, "spreads_m", optionalNumber, 4096);
  if (heightsM.length !== spreadsM.length) throw new CheckError("spreads_m", "its length is not that of heights_m");
  return { lengthM: asNumber(o.length_m, "length_m", 0), heightsM, spreadsM };
}

function readVolume(o: JsonObject): VolumeText {
  const number = (key: string) => asNumber(o[key], key);
  return {
    cellM: number("cell_m"),
    cells: asInteger(o.cells, "cells", 0),
    filled: asNumber(o.filled, "filled", 0, 1 + 1e-9),
    planAreaM2: number("plan_area_m2"),
    surfaceAreaM2: number("surface_area_m2"),
    cutM3: number("cut_m3"),
    fillM3: number("fill_m3"),
    netM3: number("net_m3"),
    sigmaM3: optionalNumber(o.sigma_m3, "sigma_m3"),
    baseMeanM: number("base_mean_m"),
  };
}

function readDrapedMap(o: JsonObject): DrapedMap {
  return {
    url: dataUrl(o.url, "url", "/data/"),
    min: asVec2(o.min, "min"),
    max: asVec2(o.max, "max"),
    scale: asNumber(o.scale, "scale"),
  };
}

function readErrorMap(o: JsonObject): ErrorMap {
  return {
    ...readDrapedMap(o),
    photos: asInteger(o.photos, "photos", 0),
    ofPhotos: asInteger(o.of_photos, "of_photos", 0),
  };
}

/** URL of a file of this server. Anything that could lead elsewhere is refused: the name is a plain relative path. */
export function dataUrl(value: unknown, path: string, folder: "/data/" | "/data/before/"): string {
  const name = asString(value, path, 300);
  if (
    !/^[A-Za-z0-9_-][A-Za-z0-9_./-]*(\?[A-Za-z0-9_.=&-]*)?$/.test(name) ||
    name.includes("..") ||
    name.includes("//")
  ) {
    throw new CheckError(path, "a path below /data/ expected");
  }
  // Written relative to the folder of the earlier project, or to /data/: both are clear.
  return folder + (folder === "/data/before/" && name.startsWith("before/") ? name.slice("before/".length) : name);
}

/** Null for a type that we do not know. Throws a CheckError that names the member. */
export function readServerText(text: string): ServerText | null {
  const o = asObject(parseJson(text, "message"), "message");
  const type = asString(o.type, "type", 100);
  const id = () => asInteger(o.id, "id", 0, U32);
  switch (type) {
    case "welcome":
      return { type, version: asInteger(o.version, "version", 0), engine: readEngine(o.engine, "engine") };
    case "engine":
      return { type, engine: readEngine(o.engine, "engine") };
    case "picked":
      return { type, id: id(), value: readPicked(o) };
    case "photos": {
      const photos = asArray(o.photos, "photos", 100_000).map((entry, i) => readSight(entry, `photos[${i}]`));
      return { type, id: id(), value: { checked: asBoolean(o.checked, "checked"), photos } };
    }
    case "profile":
      return { type, id: id(), value: readProfile(o) };
    case "volume":
      return { type, id: id(), value: readVolume(o) };
    case "error_map":
      return { type, id: id(), value: readErrorMap(o) };
    case "trust_map":
      return { type, id: id(), value: readDrapedMap(o) };
    case "progress":
      return { type, id: id(), fraction: Math.min(1, Math.max(0, asNumber(o.fraction, "fraction"))) };
    case "error":
      return {
        type,
        id: optional(o.id, "id", (value, path) => asInteger(value, path, 0, U32)),
        message: asString(o.message, "message", 4000),
      };
    default:
      return null;
  }
}
