// Small GLB files for the tests of this folder.
import type { JsonObject } from "../../../src/base/check.js";

/** A GLB of this document and binary part. */
export function glb(document: unknown, binary: Uint8Array = new Uint8Array(0)): ArrayBuffer {
  const text = JSON.stringify(document);
  const json = new TextEncoder().encode(text.padEnd(Math.ceil(text.length / 4) * 4));
  const padded = Math.ceil(binary.length / 4) * 4;
  const bytes = new ArrayBuffer(12 + 8 + json.length + 8 + padded);
  const view = new DataView(bytes);
  const words = [0x46546c67, 2, bytes.byteLength, json.length, 0x4e4f534a];
  for (const [i, word] of words.entries()) view.setUint32(4 * i, word, true);
  new Uint8Array(bytes).set(json, 20);
  view.setUint32(20 + json.length, padded, true);
  view.setUint32(24 + json.length, 0x004e4942, true);
  new Uint8Array(bytes).set(binary, 28 + json.length);
  return bytes;
}

/** One triangle: (0, 0, 0), (2, 0, 0), (0, 3, -4). */
export const TRIANGLE = Float32Array.from([0, 0, 0, 2, 0, 0, 0, 3, -4]);

export function triangleDocument(patch: JsonObject = {}): JsonObject {
  return {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorFactor: [0.5, 0, 1, 1], metallicFactor: 1 } }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, -4], max: [2, 3, 0] }],
    bufferViews: [{ buffer: 0, byteLength: 36 }],
    buffers: [{ byteLength: 36 }],
    ...patch,
  };
}

export function triangleGlb(patch: JsonObject = {}, positions: Float32Array = TRIANGLE): ArrayBuffer {
  return glb(triangleDocument(patch), new Uint8Array(positions.buffer));
}

/** First bytes of a PNG of this size. */
export function pngHeader(width: number, height: number): Uint8Array {
  const bytes = new Uint8Array(33);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, 0x89504e47);
  view.setUint32(4, 0x0d0a1a0a);
  view.setUint32(8, 13);
  view.setUint32(12, 0x49484452);
  view.setUint32(16, width);
  view.setUint32(20, height);
  return bytes;
}
