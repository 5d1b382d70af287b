// manifest.json of an exported tour: which pictures its stops have, and what its export had to leave out.
import {
  asArray,
  asChoice,
  asInteger,
  asList,
  asNumber,
  asObject,
  asString,
  CheckError,
  member,
  optional,
  optionalString,
} from "../base/check.js";

export const MANIFEST_VERSION = 1;

export interface PictureSize {
  readonly width: number;
  readonly height: number;
  /** Range of the depths; both 0 where nothing is near. */
  readonly nearM: number;
  readonly farM: number;
  /** 0: there are no depths. */
  readonly depthWidth: number;
  readonly depthHeight: number;
}

/** The view of a stop itself. */
export interface StillSize extends PictureSize {
  readonly image: "jpg" | "png";
}

export interface StopPictures {
  readonly still: StillSize | null;
  readonly panorama: PictureSize | null;
}

export interface TourManifest {
  /** By the ids of the stops. */
  readonly stops: ReadonlyMap<string, StopPictures>;
  /** Sentences for the user. */
  readonly missing: readonly string[];
  /** Names of the files in data/, without tiles and pictures of stops; null: not known. */
  readonly files: ReadonlySet<string> | null;
  readonly madeBy: string | null;
  readonly date: string | null;
}

const MOST_SIDE_PX = 16384;
const MOST_SENTENCES = 1000;
const MOST_FILES = 1_000_000;

/** Throws a CheckError when it is no manifest. Stops whose pictures are described in a way that is not understood have none, and a sentence says so. */
export function readTourManifest(value: unknown): TourManifest {
  const o = asObject(value, "manifest");
  const version = asInteger(o.version, "version", 1);
  const missing = asArray(o.missing ?? [], "missing", MOST_SENTENCES).map((text, i) => asString(text, `missing[${i}]`));
  if (version !== MANIFEST_VERSION) {
    missing.push(`The export is of version ${version}, and version ${MANIFEST_VERSION} is known here.`);
  }
  const stops = new Map<string, StopPictures>();
  for (const [id, entry] of Object.entries(asObject(o.stops, "stops"))) {
    try {
      stops.set(id, readStop(entry, `stops.${id}`));
    } catch (error) {
      if (!(error instanceof CheckError)) throw error;
      missing.push(`The pictures of the stop "${id}" are left out, because they are not understood: ${error.message}.`);
    }
  }
  const files = optional(o.files, "files", (given, path) => new Set(asList(given, path, asString, MOST_FILES)));
  const madeBy = optionalString(o.made_by, "made_by");
  return { stops, missing, files, madeBy, date: optionalString(o.date, "date") };
}

function readStop(value: unknown, path: string): StopPictures {
  const o = asObject(value, path);
  return {
    still: optional(o.still, member(path, "still"), (given, at) => ({
      ...readSize(given, at),
      image: asChoice(asObject(given, at).image, member(at, "image"), ["jpg", "png"]),
    })),
    panorama: optional(o.panorama, member(path, "panorama"), (given, at) => {
      const size = readSize(given, at);
      if (size.width % 2 !== 0 || size.height * 2 !== size.width) {
        throw new CheckError(at, `a panorama is twice as wide as high, found ${size.width} x ${size.height}`);
      }
      return size;
    }),
  };
}

function readSize(value: unknown, path: string): PictureSize {
  const o = asObject(value, path);
  const side = (key: string) => asInteger(o[key], member(path, key), 1, MOST_SIDE_PX);
  const size = {
    width: side("width"),
    height: side("height"),
    nearM: asNumber(o.near, member(path, "near"), 0),
    farM: asNumber(o.far, member(path, "far"), 0),
    depthWidth: asInteger(o.depth_width, member(path, "depth_width"), 0, MOST_SIDE_PX),
    depthHeight: asInteger(o.depth_height, member(path, "depth_height"), 0, MOST_SIDE_PX),
  };
  if (!hasDepth(size)) return { ...size, depthWidth: 0, depthHeight: 0 };
  const fits = size.depthWidth === Math.ceil(size.width / 2) && size.depthHeight === Math.ceil(size.height / 2);
  if (!fits) throw new CheckError(member(path, "depth_width"), "the depths are not half as large as the picture");
  if (!(size.nearM > 0 && size.farM >= size.nearM)) throw new CheckError(member(path, "near"), "it is not before far");
  return size;
}

/** Without a range there is no surface anywhere, and no file. */
export function hasDepth({ nearM, farM, depthWidth, depthHeight }: PictureSize): boolean {
  return depthWidth > 0 && depthHeight > 0 && !(nearM === 0 && farM === 0);
}
