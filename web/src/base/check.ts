// Readers for values of unknown shape: JSON from the server, files, the browser's storage. Each returns a typed value or throws a CheckError that
// names the place ("photos[3].rotation: 4 numbers expected, found text"). NaN and infinity are never numbers here, "12abc" is never 12.
import type { Quat, Vec2, Vec3 } from "./vec.js";

export class CheckError extends Error {
  /** Where, for instance "photos[3].rotation". */
  readonly path: string;

  constructor(path: string, message: string) {
    super(`${path === "" ? "value" : path}: ${message}`);
    this.name = "CheckError";
    this.path = path;
  }
}

export type JsonObject = Readonly<Record<string, unknown>>;
/** Reads one value; `path` is its place, for errors. */
export type Reader<T> = (value: unknown, path: string) => T;

const MAX_TEXT = 65536;

/** Path of a member. */
export function member(path: string, key: string): string {
  return path === "" ? key : `${path}.${key}`;
}

/** What a value is, in the words of an error message; never its text, which may be long or secret. */
function kind(value: unknown): string {
  if (value === undefined) return "nothing";
  if (value === null) return "null";
  if (Array.isArray(value)) return `a list of ${value.length}`;
  if (typeof value === "string") return "text";
  if (typeof value === "number" || typeof value === "boolean") return String(value);
  return typeof value === "object" ? "an object" : typeof value;
}

export function asObject(value: unknown, path: string): JsonObject {
  if (typeof value !== "object" || value === null || Array.isArray(value)) {
    throw new CheckError(path, `an object expected, found ${kind(value)}`);
  }
  return value as JsonObject;
}

export function asArray(value: unknown, path: string, maxLength = Number.POSITIVE_INFINITY): readonly unknown[] {
  if (!Array.isArray(value)) throw new CheckError(path, `a list expected, found ${kind(value)}`);
  if (value.length > maxLength)
    throw new CheckError(path, `at most ${maxLength} entries allowed, found ${value.length}`);
  return value;
}

/** Each entry read by `read`. */
export function asList<T>(value: unknown, path: string, read: Reader<T>, maxLength?: number): T[] {
  return asArray(value, path, maxLength).map((entry, i) => read(entry, `${path}[${i}]`));
}

/** A finite number in [min, max]. */
export function asNumber(
  value: unknown,
  path: string,
  min = Number.NEGATIVE_INFINITY,
  max = Number.POSITIVE_INFINITY,
): number {
  if (typeof value !== "number" || !Number.isFinite(value)) {
    throw new CheckError(path, `a number expected, found ${kind(value)}`);
  }
  if (value < min) throw new CheckError(path, `${value} is too small, at least ${min} expected`);
  if (value > max) throw new CheckError(path, `${value} is too large, at most ${max} expected`);
  return value;
}

export function asInteger(
  value: unknown,
  path: string,
  min = Number.MIN_SAFE_INTEGER,
  max = Number.MAX_SAFE_INTEGER,
): number {
  const number = asNumber(value, path, min, max);
  if (!Number.isSafeInteger(number)) throw new CheckError(path, `a whole number expected, found ${number}`);
  return number;
}

export function asString(value: unknown, path: string, maxLength = MAX_TEXT): string {
  if (typeof value !== "string") throw new CheckError(path, `text expected, found ${kind(value)}`);
  if (value.length > maxLength) {
    throw new CheckError(path, `at most ${maxLength} characters allowed, found ${value.length}`);
  }
  return value;
}

export function asBoolean(value: unknown, path: string): boolean {
  if (typeof value !== "boolean") throw new CheckError(path, `true or false expected, found ${kind(value)}`);
  return value;
}

/** One of the given texts. */
export function asChoice<T extends string>(value: unknown, path: string, choices: readonly T[]): T {
  const found = choices.find((choice) => choice === value);
  if (found === undefined) throw new CheckError(path, `one of ${choices.join(", ")} expected, found ${kind(value)}`);
  return found;
}

/** Null when the value is null or not there. */
export function optional<T>(value: unknown, path: string, read: Reader<T>): T | null {
  return value === undefined || value === null ? null : read(value, path);
}

export function optionalNumber(value: unknown, path: string): number | null {
  return optional(value, path, (given, at) => asNumber(given, at));
}

export function optionalString(value: unknown, path: string): string | null {
  return optional(value, path, (given, at) => asString(given, at));
}

export function optionalBoolean(value: unknown, path: string): boolean | null {
  return optional(value, path, asBoolean);
}

/** Exactly `length` finite numbers; any number of them when `length` is left out. */
export function asNumbers(value: unknown, path: string, length?: number): number[] {
  const entries = asArray(value, path);
  if (length !== undefined && entries.length !== length) {
    throw new CheckError(path, `${length} numbers expected, found ${kind(value)}`);
  }
  return entries.map((entry, i) => asNumber(entry, `${path}[${i}]`));
}

export function asVec2(value: unknown, path: string): Vec2 {
  const [x = 0, y = 0] = asNumbers(value, path, 2);
  return [x, y];
}

export function asVec3(value: unknown, path: string): Vec3 {
  const [x = 0, y = 0, z = 0] = asNumbers(value, path, 3);
  return [x, y, z];
}

/** A rotation w, x, y, z; lengths within 1 % of 1 are made 1, others are errors. */
export function asQuat(value: unknown, path: string): Quat {
  const [w = 0, x = 0, y = 0, z = 0] = asNumbers(value, path, 4);
  const length = Math.hypot(w, x, y, z);
  if (!(Math.abs(length - 1) < 0.01)) throw new CheckError(path, `a quaternion of length 1 expected, found ${length}`);
  return [w / length, x / length, y / length, z / length];
}

/** JSON.parse whose error names what was read. */
export function parseJson(text: string, what: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    throw new CheckError(what, "it is not valid JSON");
  }
}
