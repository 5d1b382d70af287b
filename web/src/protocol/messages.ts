// The texts that the browser sends (docs/viewer_protocol.md): JSON of at most 4096 bytes, every number finite and within the server's limits. A value
// beyond them is a RangeError here, because the tenth bad message in a row would close the connection.
import type { Quat, Vec2, Vec3 } from "../base/vec.js";
import type { VolumeBase } from "../state/app_state.js";

export const PROTOCOL_VERSION = 1;
export const MAX_MESSAGE_BYTES = 4096;
export const MIN_VIEW_PX = 16;
export const MAX_VIEW_PX = 2048;
export const MAX_POLYGON_CORNERS = 64;
export const MAX_PROFILE_SAMPLES = 1024;
const MAX_COORDINATE_M = 1e7;

type Which = "main" | "before";

/** As link_api.ts has it; repeated, because that file needs the DOM library. */
export interface ViewFields {
  readonly project: Which;
  readonly eyeEnu: Vec3;
  readonly rotation: Quat;
  readonly fovyDeg: number | null;
  readonly orthoHeightM: number | null;
  readonly w: number;
  readonly h: number;
}
export interface RayFields {
  readonly originEnu: Vec3;
  readonly direction: Vec3;
  readonly pixelPitch: number;
  readonly pixelWidthM: number;
}

function within(value: number, min: number, max: number, what: string): number {
  if (!(value >= min && value <= max)) throw new RangeError(`${what} is ${value}; ${min} to ${max} is possible`);
  // -0 is "0" in JSON anyway; said here so that nobody wonders.
  return value === 0 ? 0 : value;
}

function coordinates(values: readonly number[], what: string): number[] {
  return values.map((value) => within(value, -MAX_COORDINATE_M, MAX_COORDINATE_M, what));
}

/** The engine wants length 1. */
function unit(values: readonly number[], what: string): number[] {
  const length = Math.hypot(...values);
  if (!(length > 1e-9) || !Number.isFinite(length)) throw new RangeError(`${what} has no length`);
  return values.map((value) => value / length);
}

function integer(value: number, min: number, max: number, what: string): number {
  return within(Math.round(value), min, max, what);
}

function text(message: Readonly<Record<string, unknown>>): string {
  const json = JSON.stringify(message);
  // All of it is ASCII: names and free texts are never sent.
  if (json.length > MAX_MESSAGE_BYTES) throw new RangeError(`a request of ${json.length} bytes is too long`);
  return json;
}

const U32 = 0xffffffff;

/** The size that is asked for: whole pixels within the engine's limits, of the same shape. */
export function viewSize(w: number, h: number): Vec2 {
  within(w, 1, 1e6, "the width of the view");
  within(h, 1, 1e6, "the height of the view");
  const fit = Math.min(1, MAX_VIEW_PX / w, MAX_VIEW_PX / h);
  return [Math.max(MIN_VIEW_PX, Math.round(w * fit)), Math.max(MIN_VIEW_PX, Math.round(h * fit))];
}

export function helloText(): string {
  return text({ type: "hello", version: PROTOCOL_VERSION });
}

export function viewText(seq: number, view: ViewFields): string {
  const [w, h] = viewSize(view.w, view.h);
  const common = {
    type: "view",
    seq: integer(seq, 0, U32, "seq"),
    project: view.project,
    eye: coordinates(view.eyeEnu, "the camera's position"),
    rotation: unit(view.rotation, "the camera's rotation"),
  };
  if (view.orthoHeightM !== null) {
    const height = within(view.orthoHeightM, 0.01, 1e6, "the height of the picture");
    return text({ ...common, projection: "orthographic", height_m: height, w, h });
  }
  if (view.fovyDeg === null) throw new RangeError("a view needs a field of view or a height");
  const fovy = within(view.fovyDeg, 1, 150, "the field of view");
  return text({ ...common, projection: "perspective", fovy_deg: fovy, w, h });
}

export function viewPhotoText(seq: number, photo: number, w: number): string {
  const [width] = viewSize(w, 1);
  return text({
    type: "view",
    seq: integer(seq, 0, U32, "seq"),
    photo: integer(photo, 0, 0x7fffffff, "photo"),
    w: width,
  });
}

export function stopText(seq: number): string {
  return text({ type: "stop", seq: integer(seq, 0, U32, "seq") });
}

export function ackText(seq: number, pass: number): string {
  return text({ type: "ack", seq: integer(seq, 0, U32, "seq"), pass: integer(pass, 0, 255, "pass") });
}

export function pickText(id: number, ray: RayFields, project: Which): string {
  return text({
    type: "pick",
    id: integer(id, 0, U32, "id"),
    project,
    origin: coordinates(ray.originEnu, "the camera's position"),
    direction: unit(ray.direction, "the direction"),
    pixel_pitch: within(ray.pixelPitch, 0, 1, "the angle of a pixel"),
    pixel_width_m: within(ray.pixelWidthM, 0, 1e4, "the width of a pixel"),
  });
}

export function photosAtText(id: number, point: Vec3): string {
  return text({ type: "photos_at", id: integer(id, 0, U32, "id"), point: coordinates(point, "the point") });
}

export function profileText(id: number, from: Vec2, to: Vec2, samples: number, project: Which): string {
  return text({
    type: "profile",
    id: integer(id, 0, U32, "id"),
    project,
    from: coordinates(from, "the profile's start"),
    to: coordinates(to, "the profile's end"),
    samples: integer(samples, 2, MAX_PROFILE_SAMPLES, "the number of samples"),
  });
}

export function volumeText(
  id: number,
  polygon: readonly Vec2[],
  base: VolumeBase,
  baseHeightM: number,
  project: Which,
): string {
  if (polygon.length < 3 || polygon.length > MAX_POLYGON_CORNERS) {
    throw new RangeError(`the outline has ${polygon.length} corners; 3 to ${MAX_POLYGON_CORNERS} are possible`);
  }
  return text({
    type: "volume",
    id: integer(id, 0, U32, "id"),
    project,
    // A tenth of a millimetre: 64 corners stay far below the limit of bytes.
    polygon: polygon.map((corner) => coordinates(corner, "a corner").map((value) => Math.round(value * 1e4) / 1e4)),
    base,
    base_height_m: within(baseHeightM, -MAX_COORDINATE_M, MAX_COORDINATE_M, "the height of the base"),
  });
}

export function errorMapText(id: number): string {
  return text({ type: "error_map", id: integer(id, 0, U32, "id") });
}

export function trustMapText(id: number): string {
  return text({ type: "trust_map", id: integer(id, 0, U32, "id") });
}

export function cancelText(id: number): string {
  return text({ type: "cancel", id: integer(id, 0, U32, "id") });
}
