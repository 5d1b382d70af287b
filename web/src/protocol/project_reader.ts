// project.json as a Project. What is wrong is named with its place in the file.
import {
  asBoolean,
  asInteger,
  asList,
  asNumber,
  asNumbers,
  asObject,
  asQuat,
  asString,
  asVec3,
  CheckError,
  type JsonObject,
  member,
  optional,
  optionalNumber,
} from "../base/check.js";
import type { Accuracy, Block, Crs, Missing, Photo, PhotoCamera, Project, ProjectBase } from "../state/project.js";
import { dataUrl } from "./replies.js";

const MAX_PHOTOS = 1_000_000;
const MAX_ENTRIES = 100_000;

function readOrigin(value: unknown, path: string): ProjectBase["origin"] {
  const o = asObject(value, path);
  return {
    latitudeDeg: asNumber(o.latitude_deg, member(path, "latitude_deg"), -90, 90),
    longitudeDeg: asNumber(o.longitude_deg, member(path, "longitude_deg"), -360, 360),
    heightM: asNumber(o.height_m, member(path, "height_m")),
  };
}

function readCrs(value: unknown, path: string): Crs {
  const o = asObject(value, path);
  return {
    name: asString(o.name, member(path, "name"), 200),
    zone: asInteger(o.zone, member(path, "zone"), 0, 60),
    north: asBoolean(o.north, member(path, "north")),
  };
}

function readAccuracy(value: unknown, path: string): Accuracy {
  const o = value === undefined || value === null ? {} : asObject(value, path);
  const sigma = (key: string) => optional(o[key], member(path, key), (given, at) => asNumber(given, at, 0));
  return {
    scalePercent: sigma("scale_percent"),
    tiltDeg: sigma("tilt_deg"),
    yawDeg: sigma("yaw_deg"),
    horizontalM: sigma("horizontal_m"),
    verticalM: sigma("vertical_m"),
  };
}

function readBlock(value: unknown, path: string): Block {
  const o = asObject(value, path);
  return {
    name: asString(o.name, member(path, "name"), 1000),
    min: asVec3(o.min_enu, member(path, "min_enu")),
    max: asVec3(o.max_enu, member(path, "max_enu")),
    empty: asBoolean(o.empty, member(path, "empty")),
    photos: asInteger(o.photos, member(path, "photos"), 0),
    psnrDb: optionalNumber(o.psnr_db, member(path, "psnr_db")),
  };
}

function readCamera(value: unknown, path: string): PhotoCamera {
  const o = asObject(value, path);
  return {
    model: asString(o.model, member(path, "model"), 100),
    width: asInteger(o.width, member(path, "width"), 1),
    height: asInteger(o.height, member(path, "height"), 1),
    params: asNumbers(o.params, member(path, "params")),
  };
}

function readPhoto(value: unknown, path: string, index: number, cameras: number): Photo {
  const o = asObject(value, path);
  return {
    index,
    name: asString(o.name, member(path, "name"), 4096),
    camera: asInteger(o.camera, member(path, "camera"), 0, cameras - 1),
    position: asVec3(o.position, member(path, "position")),
    rotation: asQuat(o.rotation, member(path, "rotation")),
    isTest: asBoolean(o.is_test, member(path, "is_test")),
    psnrDb: optionalNumber(o.psnr_db, member(path, "psnr_db")),
    available: asBoolean(o.available, member(path, "available")),
  };
}

type FilesFolder = "/data/" | "/data/before/";

function readBuildingFiles(value: unknown, path: string, folder: FilesFolder): ProjectBase["buildings"] {
  const o = asObject(value, path);
  const url = (given: unknown, at: string) => dataUrl(given, at, folder);
  return {
    count: asInteger(o.count, member(path, "count"), 0),
    url: url(o.url, member(path, "url")),
    files: asList(o.files, member(path, "files"), url, 100),
  };
}

function readMissing(value: unknown, path: string): Missing {
  const o = asObject(value, path);
  return {
    what: asString(o.what, member(path, "what"), 1000),
    reason: asString(o.reason, member(path, "reason"), 10_000),
    advice: asString(o.advice, member(path, "advice"), 10_000),
  };
}

/** The numbers of metrics.json; its texts and lists are not for the viewer. */
function readMetrics(value: unknown, path: string): Record<string, number | null> {
  const metrics: Record<string, number | null> = {};
  for (const [key, entry] of Object.entries(asObject(value, path))) {
    if (entry === null || (typeof entry === "number" && Number.isFinite(entry))) metrics[key] = entry;
  }
  return metrics;
}

function readBase(o: JsonObject, path: string, folder: FilesFolder): ProjectBase {
  const at = (key: string) => member(path, key);
  const url = (key: string) => optional(o[key], at(key), (value, place) => dataUrl(value, place, folder));
  const min = asVec3(o.min_enu, at("min_enu"));
  const max = asVec3(o.max_enu, at("max_enu"));
  min.forEach((low, i) => {
    if (!(low <= (max[i] ?? Number.NaN))) throw new CheckError(at("max_enu"), "it is less than min_enu");
  });
  const cameras = asList(o.cameras, at("cameras"), readCamera, MAX_ENTRIES);
  const photos = asList(o.photos, at("photos"), (value) => value, MAX_PHOTOS);
  const gsdM = optionalNumber(o.gsd_m, at("gsd_m"));
  const diagonalM = Math.hypot(max[0] - min[0], max[1] - min[1]);
  return {
    name: asString(o.name, at("name"), 4096),
    revision: asInteger(o.revision, at("revision"), 0),
    georeferenced: asBoolean(o.georeferenced, at("georeferenced")),
    origin: readOrigin(o.origin, at("origin")),
    crs: optional(o.crs, at("crs"), readCrs),
    vertical: asString(o.vertical, at("vertical"), 1000),
    accuracy: readAccuracy(o.accuracy, at("accuracy")),
    min,
    max,
    groundM: optionalNumber(o.ground_m, at("ground_m")) ?? min[2],
    // Unknown without photos: then a size that moves and snaps sensibly in a scene of this extent.
    gsdM: gsdM !== null && gsdM > 0 ? gsdM : Math.max(0.01, diagonalM / 4000),
    scene: optional(o.scene, at("scene"), (value, place) => {
      const scene = asObject(value, place);
      return {
        blocks: asInteger(scene.blocks, member(place, "blocks"), 0),
        parameters: asInteger(scene.parameters, member(place, "parameters"), 0),
        trust: asBoolean(scene.trust, member(place, "trust")),
      };
    }),
    tiles: url("tiles"),
    terrain: url("terrain"),
    orthophoto: url("orthophoto"),
    points: url("points"),
    contours: url("contours"),
    surface: optional(o.surface, at("surface"), (value, place) => {
      const surface = asObject(value, place);
      return {
        triangles: asInteger(surface.triangles, member(place, "triangles"), 0),
        points: asInteger(surface.points, member(place, "points"), 0),
        areaM2: asNumber(surface.area_m2, member(place, "area_m2"), 0),
        voxelM: asNumber(surface.voxel_m, member(place, "voxel_m"), 0),
      };
    }),
    buildings: optional(o.buildings, at("buildings"), (value, place) => readBuildingFiles(value, place, folder)),
    blocks: asList(o.blocks, at("blocks"), readBlock, MAX_ENTRIES),
    cameras,
    photos: photos.map((value, i) => readPhoto(value, `${at("photos")}[${i}]`, i, cameras.length)),
    metrics: optional(o.metrics, at("metrics"), readMetrics),
    missing: asList(o.missing, at("missing"), readMissing, 1000),
  };
}

/** Throws a CheckError that names the member. */
export function readProject(value: unknown): Project {
  const o = asObject(value, "project");
  const before = optional(o.before, "before", (given, path) => {
    const b = asObject(given, path);
    return {
      ...readBase(b, path, "/data/before/"),
      enuFromBefore: asNumbers(b.enu_from_before, member(path, "enu_from_before"), 16),
    };
  });
  return { ...readBase(o, "", "/data/"), before };
}
