// An exact frame as bytes (docs/viewer_protocol.md): header of 128 bytes, colour, depth. Every length is checked before a view of the bytes is made.
import { CheckError } from "../base/check.js";
import type { Quat, Vec3 } from "../base/vec.js";

const HEADER_BYTES = 128;
const MAX_SIDE_PX = 4096;
const FLAG_BEFORE = 1;
const FLAG_ORTHOGRAPHIC = 2;
const FLAG_PHOTO = 4;

export interface FrameHeader {
  readonly seq: number;
  readonly revision: number;
  readonly pass: number;
  readonly passes: number;
  readonly format: "jpeg" | "png";
  readonly project: "main" | "before";
  readonly isPhoto: boolean;
  readonly width: number;
  readonly height: number;
  readonly eyeEnu: Vec3;
  /** cam_from_enu, w x y z. */
  readonly rotation: Quat;
  readonly fovyDeg: number | null;
  readonly orthoHeightM: number | null;
  readonly nearM: number;
  readonly farM: number;
  readonly depthWidth: number;
  readonly depthHeight: number;
}
export interface FrameBytes {
  readonly header: FrameHeader;
  /** File of a JPEG or PNG. */
  readonly color: Uint8Array<ArrayBuffer>;
  /** Raw deflate; empty: no depth. */
  readonly depth: Uint8Array<ArrayBuffer>;
}
/** Raw deflate (RFC 1951) to exactly `bytes` bytes; rejects when it is damaged or longer. */
export type Inflate = (packed: Uint8Array<ArrayBuffer>, bytes: number) => Promise<Uint8Array<ArrayBuffer>>;

function refuse(field: string, message: string): never {
  throw new CheckError(`frame.${field}`, message);
}

function finite(value: number, field: string): number {
  if (!Number.isFinite(value)) refuse(field, `${value} is not a number`);
  return value;
}

/** Throws a CheckError for bytes that are not a frame. */
export function parseFrame(bytes: ArrayBuffer): FrameBytes {
  if (bytes.byteLength < HEADER_BYTES) refuse("length", `${bytes.byteLength} bytes are less than a header`);
  const view = new DataView(bytes);
  if (view.getUint32(0, false) !== 0x534b5946) refuse("magic", "it does not begin with SKYF");
  const version = view.getUint16(4, true);
  if (version !== 1) refuse("version", `${version} is unknown: reload the page`);
  if (view.getUint16(6, true) !== HEADER_BYTES) refuse("header", "its length is not 128");
  const format = view.getUint8(18);
  if (format > 1) refuse("format", `${format} is unknown`);
  const flags = view.getUint8(19);
  if ((flags & ~(FLAG_BEFORE | FLAG_ORTHOGRAPHIC | FLAG_PHOTO)) !== 0) refuse("flags", `${flags} is unknown`);
  const pass = view.getUint8(16);
  const passes = view.getUint8(17);
  if (pass >= passes) refuse("pass", `${pass} of ${passes}`);
  const width = view.getUint16(20, true);
  const height = view.getUint16(22, true);
  if (width < 1 || height < 1 || width > MAX_SIDE_PX || height > MAX_SIDE_PX) refuse("size", `${width} x ${height}`);
  const rectangle = [24, 26, 28, 30].map((at) => view.getUint16(at, true));
  // One message per pass: a frame is shown whole or not at all.
  if (rectangle[0] !== 0 || rectangle[1] !== 0 || rectangle[2] !== width || rectangle[3] !== height) {
    refuse("rectangle", `${rectangle.join(", ")} is not the whole picture of ${width} x ${height}`);
  }
  const number = (at: number, field: string) => finite(view.getFloat64(at, true), field);
  const eyeEnu: Vec3 = [number(32, "eye"), number(40, "eye"), number(48, "eye")];
  const q: Quat = [number(56, "rotation"), number(64, "rotation"), number(72, "rotation"), number(80, "rotation")];
  const length = Math.hypot(q[0], q[1], q[2], q[3]);
  if (Math.abs(length - 1) > 1e-3) refuse("rotation", `its length is ${length}`);
  const size = number(88, "field of view");
  const orthographic = (flags & FLAG_ORTHOGRAPHIC) !== 0;
  if (!(size > 0) || (!orthographic && size >= 180)) refuse("field of view", String(size));
  const nearM = finite(view.getFloat32(96, true), "near");
  const farM = finite(view.getFloat32(100, true), "far");
  const depthWidth = view.getUint16(104, true);
  const depthHeight = view.getUint16(106, true);
  const colorBytes = view.getUint32(108, true);
  const depthBytes = view.getUint32(112, true);
  if (HEADER_BYTES + colorBytes + depthBytes !== bytes.byteLength) {
    refuse("length", `${colorBytes} + ${depthBytes} bytes announced, ${bytes.byteLength - HEADER_BYTES} received`);
  }
  if (colorBytes === 0) refuse("colour", "it is empty");
  if (depthBytes > 0) {
    if (depthWidth !== Math.ceil(width / 2) || depthHeight !== Math.ceil(height / 2)) {
      refuse("depth", `${depthWidth} x ${depthHeight} is not half of ${width} x ${height}`);
    }
    if (!(farM >= nearM) || (!orthographic && !(nearM > 0))) refuse("depth", `near ${nearM}, far ${farM}`);
  }
  return {
    header: {
      seq: view.getUint32(8, true),
      revision: view.getUint32(12, true),
      pass,
      passes,
      format: format === 0 ? "jpeg" : "png",
      project: (flags & FLAG_BEFORE) !== 0 ? "before" : "main",
      isPhoto: (flags & FLAG_PHOTO) !== 0,
      width,
      height,
      eyeEnu,
      rotation: [q[0] / length, q[1] / length, q[2] / length, q[3] / length],
      fovyDeg: orthographic ? null : size,
      orthoHeightM: orthographic ? size : null,
      nearM,
      farM,
      depthWidth: depthBytes > 0 ? depthWidth : 0,
      depthHeight: depthBytes > 0 ? depthHeight : 0,
    },
    color: new Uint8Array(bytes, HEADER_BYTES, colorBytes),
    depth: new Uint8Array(bytes, HEADER_BYTES + colorBytes, depthBytes),
  };
}

/** Metres along the optical axis, row by row; NaN: no surface. Empty when the frame has no depth. */
export function inflateDepth({ header, depth }: FrameBytes, inflate: Inflate): Promise<Float32Array<ArrayBuffer>> {
  const { depthWidth, depthHeight, nearM, farM, fovyDeg } = header;
  return unpackDepths(depth, { count: depthWidth * depthHeight, nearM, farM, inverse: fovyDeg !== null }, inflate);
}

export interface DepthCode {
  readonly count: number;
  readonly nearM: number;
  readonly farM: number;
  /** Steps of the inverse; else of the depth itself. */
  readonly inverse: boolean;
}

/** Depths as core/image/depth_code.h packs them; NaN: no surface. */
export async function unpackDepths(
  packed: Uint8Array<ArrayBuffer>,
  { count, nearM, farM, inverse }: DepthCode,
  inflate: Inflate,
): Promise<Float32Array<ArrayBuffer>> {
  const depth = new Float32Array(count);
  if (count === 0) return depth;
  const bytes = await inflate(packed, 2 * count);
  if (bytes.byteLength !== 2 * count) refuse("depth", `${bytes.byteLength} bytes instead of ${2 * count}`);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const first = inverse ? 1 / farM : nearM;
  const step = (inverse ? 1 / nearM - 1 / farM : farM - nearM) / 65534;
  for (let i = 0; i < count; ++i) {
    const q = view.getUint16(2 * i, true);
    const value = first + (q - 1) * step;
    depth[i] = q === 0 ? Number.NaN : inverse ? 1 / value : value;
  }
  return depth;
}
