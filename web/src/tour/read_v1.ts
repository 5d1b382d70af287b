// Reads version 1 of tour.json. Whoever reads decides what happens to parts that are not known: the editor refuses them, the player leaves them out.
// References between the parts are checked elsewhere (references.ts).
import {
  asArray,
  asBoolean,
  asChoice,
  asInteger,
  asNumber,
  asObject,
  asString,
  asVec3,
  CheckError,
  type JsonObject,
  optional,
  type Reader,
} from "../base/check.js";
import type { Quat, Vec3 } from "../base/vec.js";
import { quatNormalize } from "../base/vec_math.js";
import {
  EXPOSURE_STOPS,
  FOVY_DEG,
  ID_PATTERN,
  LARGEST_COORDINATE,
  LONGEST_PAUSE_S,
  MODEL_PATTERN,
  MOST_BRANCHES,
  MOST_MEASUREMENTS,
  MOST_STOPS,
  MOST_THINGS,
  PICTURE_PATTERN,
  SCALE,
} from "./limits.js";
import { asLine, asText, asUrl } from "./text_rules.js";
import {
  type Asset,
  type Branch,
  LAYER_NAMES,
  type Next,
  type Path,
  type Stop,
  type Thing,
  type Tour,
} from "./types.js";

const THING_KINDS = ["label", "marker", "model"] as const;
const PATH_KINDS = ["direct", "orbit", "over", "jump"] as const;
const MOST_ASSETS = MOST_STOPS + MOST_THINGS;

export interface Leniency {
  /** A member that this version does not have. */
  unknownMember(path: string, key: string): void;
  /** A layer, a kind of thing or of path that this version does not have; `name` says whose it is. */
  unknownChoice(path: string, error: CheckError, name: string): void;
  /** An entry of a list cannot be read. */
  badEntry(error: CheckError, name: string): void;
}

function fail(_path: string, error: CheckError): never {
  throw error;
}

export const STRICT: Leniency = {
  unknownMember: (path, key) => {
    throw new CheckError(path, `unknown member "${shortened(key)}"`);
  },
  unknownChoice: fail,
  badEntry: (error) => fail("", error),
};

/** A text of the file in a message: not longer than it is useful. */
export function shortened(text: string): string {
  const characters = [...text];
  return characters.length <= 60 ? text : `${characters.slice(0, 59).join("")}…`;
}

/** Everything but the version. Throws CheckError. */
export function readParts(root: JsonObject, leniency: Leniency): Tour {
  const parts = new PartReader(leniency);
  parts.members(root, "", ["version", "title", "start", "stops", "things", "assets"]);
  const stops = parts.entries(root.stops, "stops", MOST_STOPS, parts.stop);
  const things = parts.entries(root.things ?? [], "things", MOST_THINGS, parts.thing);
  return {
    title: optional(root.title, "title", (value, path) => asLine(value, path, 0)) ?? "",
    start: optional(root.start, "start", asId),
    stops,
    things: things.filter((thing) => thing !== null),
    assets: parts.assets(root.assets ?? {}, "assets"),
  };
}

function asId(value: unknown, path: string): string {
  const id = asString(value, path);
  if (!ID_PATTERN.test(id)) throw new CheckError(path, "1 to 40 letters, digits, - and _ expected");
  return id;
}

function asPlace(value: unknown, path: string): Vec3 {
  const place = asVec3(value, path);
  place.forEach((coordinate, i) => {
    asNumber(coordinate, `${path}[${i}]`, -LARGEST_COORDINATE, LARGEST_COORDINATE);
  });
  return place;
}

function asRotation(value: unknown, path: string): Quat {
  const numbers = asArray(value, path, 4).map((entry, i) => asNumber(entry, `${path}[${i}]`));
  const [w = 0, x = 0, y = 0, z = 0] = numbers;
  const length = Math.hypot(w, x, y, z);
  if (numbers.length !== 4 || !(Math.abs(length - 1) <= 1e-6)) {
    throw new CheckError(path, "a quaternion w, x, y, z of length 1 expected");
  }
  // What has length 1 to the last bits stays as it is, so that reading and writing changes nothing.
  return Math.abs(length - 1) < 1e-12 ? [w, x, y, z] : quatNormalize([w, x, y, z]);
}

function asAssetName(value: unknown, path: string, pattern: RegExp, kinds: string): string {
  const name = asString(value, path);
  if (!pattern.test(name)) {
    throw new CheckError(path, `the name of an asset expected: 64 hexadecimal digits, then ${kinds}`);
  }
  return name;
}

/** For messages, also of entries that cannot be read. */
function nameOf(value: unknown): string {
  if (typeof value !== "object" || value === null) return "";
  const { title, name, text, label, id } = value as JsonObject;
  const found = [title, name, text, label, id].find((one) => typeof one === "string" && one !== "");
  return typeof found === "string" ? shortened(found) : "";
}

class PartReader {
  private readonly leniency: Leniency;
  private readonly ids = new Set<string>();

  constructor(leniency: Leniency) {
    this.leniency = leniency;
  }

  members(object: JsonObject, path: string, known: readonly string[]): void {
    for (const key of Object.keys(object)) {
      if (!known.includes(key)) this.leniency.unknownMember(path, key);
    }
  }

  entries<T>(value: unknown, path: string, most: number, read: Reader<T>): T[] {
    return asArray(value, path, most).flatMap((entry, i) => {
      try {
        return [read(entry, `${path}[${i}]`)];
      } catch (error) {
        if (!(error instanceof CheckError)) throw error;
        this.leniency.badEntry(error, nameOf(entry));
        return [];
      }
    });
  }

  readonly stop = (value: unknown, path: string): Stop => {
    const stop = asObject(value, path);
    this.members(stop, path, [
      "id",
      "title",
      "text",
      "picture",
      "link",
      "pose",
      "exposure_stops",
      "layers",
      "measurements",
      "pause_s",
      "next",
      "branches",
    ]);
    const read = {
      title: asLine(stop.title, `${path}.title`),
      text: optional(stop.text, `${path}.text`, asText) ?? "",
      picture: optional(stop.picture, `${path}.picture`, (given, at) =>
        asAssetName(given, at, PICTURE_PATTERN, ".png or .jpg"),
      ),
      link: optional(stop.link, `${path}.link`, (given, at) => {
        const link = asObject(given, at);
        this.members(link, at, ["label", "url"]);
        return { label: asLine(link.label, `${at}.label`), url: asUrl(link.url, `${at}.url`) };
      }),
      pose: this.pose(stop.pose, `${path}.pose`),
      exposureStops: optional(stop.exposure_stops, `${path}.exposure_stops`, (given, at) =>
        asNumber(given, at, EXPOSURE_STOPS.least, EXPOSURE_STOPS.most),
      ),
      layers: optional(stop.layers, `${path}.layers`, (given, at) => this.layers(given, at, nameOf(stop))),
      measurements: asArray(stop.measurements ?? [], `${path}.measurements`, MOST_MEASUREMENTS).map((id, i) =>
        asLine(id, `${path}.measurements[${i}]`),
      ),
      pauseS: asNumber(stop.pause_s ?? 0, `${path}.pause_s`, 0, LONGEST_PAUSE_S),
      next: optional(stop.next, `${path}.next`, (given, at) => this.next(given, at, nameOf(stop))),
      branches: this.entries(stop.branches ?? [], `${path}.branches`, MOST_BRANCHES, this.branch),
    };
    // Last, so that an entry that is left out takes no id.
    return { id: this.newId(stop.id, `${path}.id`), ...read };
  };

  readonly thing = (value: unknown, path: string): Thing | null => {
    const thing = asObject(value, path);
    const kind = this.choice(thing.kind, `${path}.kind`, THING_KINDS, nameOf(thing));
    if (kind === null) return null;
    const known = ["id", "kind", "at", "stops"];
    const base = () => ({
      at: asPlace(thing.at, `${path}.at`),
      stops: optional(thing.stops, `${path}.stops`, (given, where) =>
        asArray(given, where, MOST_STOPS).map((id, i) => asId(id, `${where}[${i}]`)),
      ),
      id: this.newId(thing.id, `${path}.id`),
    });
    switch (kind) {
      case "label":
        this.members(thing, path, [...known, "text"]);
        return { kind, text: asLine(thing.text, `${path}.text`), ...base() };
      case "marker":
        this.members(thing, path, [...known, "text", "to"]);
        return {
          kind,
          text: asLine(thing.text, `${path}.text`),
          to: optional(thing.to, `${path}.to`, asId),
          ...base(),
        };
      case "model":
        this.members(thing, path, [...known, "yaw_deg", "scale", "name", "asset"]);
        return {
          kind,
          name: asLine(thing.name, `${path}.name`),
          yawDeg: asNumber(thing.yaw_deg, `${path}.yaw_deg`, -360, 360),
          scale: asNumber(thing.scale, `${path}.scale`, SCALE.least, SCALE.most),
          asset: asAssetName(thing.asset, `${path}.asset`, MODEL_PATTERN, ".glb"),
          ...base(),
        };
      default:
        return kind satisfies never;
    }
  };

  assets(value: unknown, path: string): ReadonlyMap<string, Asset> {
    const entries = Object.entries(asObject(value, path));
    if (entries.length > MOST_ASSETS)
      throw new CheckError(path, `at most ${MOST_ASSETS} allowed, found ${entries.length}`);
    const assets = new Map<string, Asset>();
    for (const [name, given] of entries) {
      const at = `${path}.${shortened(name)}`;
      if (!PICTURE_PATTERN.test(name) && !MODEL_PATTERN.test(name)) {
        throw new CheckError(at, "64 hexadecimal digits, then .glb, .png or .jpg expected as its name");
      }
      const asset = asObject(given, at);
      this.members(asset, at, ["name", "bytes"]);
      assets.set(name, { name: asLine(asset.name, `${at}.name`), bytes: asInteger(asset.bytes, `${at}.bytes`, 1) });
    }
    return assets;
  }

  private readonly branch = (value: unknown, path: string): Branch => {
    const branch = asObject(value, path);
    this.members(branch, path, ["to", "label", "path"]);
    return {
      to: asId(branch.to, `${path}.to`),
      label: asLine(branch.label, `${path}.label`),
      path: this.path(branch.path, `${path}.path`, nameOf(branch)),
    };
  };

  private next(value: unknown, path: string, name: string): Next {
    const next = asObject(value, path);
    this.members(next, path, ["to", "path"]);
    return { to: optional(next.to, `${path}.to`, asId), path: this.path(next.path, `${path}.path`, name) };
  }

  /** An unknown kind becomes a direct way. */
  private path(value: unknown, path: string, name: string): Path {
    const given = asObject(value, path);
    const kind = this.choice(given.kind, `${path}.kind`, PATH_KINDS, name);
    if (kind === null) return { kind: "direct" };
    if (kind === "orbit") {
      this.members(given, path, ["kind", "about"]);
      return { kind, about: asPlace(given.about, `${path}.about`) };
    }
    this.members(given, path, ["kind"]);
    return { kind };
  }

  private pose(value: unknown, path: string) {
    const pose = asObject(value, path);
    this.members(pose, path, ["eye_enu", "rotation", "fovy_deg"]);
    return {
      eyeEnu: asPlace(pose.eye_enu, `${path}.eye_enu`),
      rotation: asRotation(pose.rotation, `${path}.rotation`),
      fovyDeg: asNumber(pose.fovy_deg, `${path}.fovy_deg`, FOVY_DEG.least, FOVY_DEG.most),
    };
  }

  private layers(value: unknown, path: string, name: string) {
    const layers = asObject(value, path);
    for (const key of Object.keys(layers)) {
      if (LAYER_NAMES.some((known) => known === key)) continue;
      const error = new CheckError(path, `unknown layer "${shortened(key)}"`);
      this.leniency.unknownChoice(`${path}.${shortened(key)}`, error, name);
    }
    return Object.fromEntries(
      LAYER_NAMES.filter((key) => Object.hasOwn(layers, key)).map((key) => [
        key,
        asBoolean(layers[key], `${path}.${key}`),
      ]),
    );
  }

  /** Null: a text that is not among them, and that is allowed. */
  private choice<T extends string>(value: unknown, path: string, choices: readonly T[], name: string): T | null {
    try {
      return asChoice(value, path, choices);
    } catch (error) {
      if (!(error instanceof CheckError) || typeof value !== "string") throw error;
      this.leniency.unknownChoice(path, error, name);
      return null;
    }
  }

  private newId(value: unknown, path: string): string {
    const id = asId(value, path);
    if (this.ids.has(id)) throw new CheckError(path, `"${id}" is the id of another stop or thing`);
    this.ids.add(id);
    return id;
  }
}
