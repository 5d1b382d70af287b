// Reads the frame of a GLB and reduces its document to what is shown: shapes with base colours. Refuses what is not in the file itself, what is packed in
// ways that need another decoder, and nodes that are no tree, which a loader would follow for ever.
import {
  asArray,
  asInteger,
  asNumber,
  asObject,
  asString,
  CheckError,
  type JsonObject,
  parseJson,
} from "../base/check.js";

export const MOST_FILE_BYTES = 50 * 2 ** 20;
const MOST_NODES = 20_000;
const MOST_PRIMITIVES = 20_000;
const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BIN_CHUNK = 0x004e4942;
/** Others may be used, but not required: without them the file still has its shape. */
const UNDERSTOOD = ["KHR_materials_unlit", "KHR_texture_transform", "KHR_mesh_quantization"];
/** Whatever they say about being required, without them there is no shape. */
const PACKED = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];
const COMPONENT_BYTES: Readonly<Record<number, number>> = { 5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4 };
const COMPONENTS: Readonly<Record<string, number>> = {
  SCALAR: 1,
  VEC2: 2,
  VEC3: 3,
  VEC4: 4,
  MAT2: 4,
  MAT3: 9,
  MAT4: 16,
};
const ATTRIBUTES = ["POSITION", "NORMAL", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0", "JOINTS_0", "WEIGHTS_0"];

export interface GlbDocument {
  /** A glTF document whose views are all of `binary`. */
  readonly json: JsonObject;
  readonly binary: Uint8Array<ArrayBuffer>;
  /** Of the geometry. */
  readonly geometryBytes: number;
  /** Encoded picture of each texture. */
  readonly pictures: readonly Uint8Array<ArrayBuffer>[];
}

/** Throws an Error that says what is wrong with the file. */
export function readGlb(bytes: ArrayBuffer): GlbDocument {
  if (bytes.byteLength > MOST_FILE_BYTES) throw new Error(`it is larger than ${MOST_FILE_BYTES / 2 ** 20} MiB`);
  const { text, binary } = chunksOf(bytes);
  const json = asObject(parseJson(text, "its JSON"), "document");
  const { asset } = json;
  const version = asString(asObject(asset, "asset").version, "asset.version", 20);
  if (!version.startsWith("2.")) throw new Error(`it is glTF ${version}, not 2.0`);
  refuseExtensions(json);
  const views = viewsOf(json, binary);
  const textures = list(json, "textures").map((texture, i) => plainTexture(texture, `textures[${i}]`));
  const images = imagesOf(json, views.length);
  const plain = {
    asset: { version: "2.0" },
    ...pick(json, ["scene"]),
    scenes: list(json, "scenes").map((scene) => pick(scene, ["nodes"])),
    nodes: nodesOf(json),
    meshes: meshesOf(json),
    accessors: list(json, "accessors").map((accessor) => {
      const keys = ["bufferView", "byteOffset", "componentType", "normalized", "count", "type", "max", "min", "sparse"];
      return pick(accessor, keys);
    }),
    bufferViews: views,
    buffers: [{ byteLength: binary.byteLength }],
    materials: list(json, "materials").map(plainMaterial),
    textures,
    samplers: list(json, "samplers"),
    images: images.map((bufferView) => ({ bufferView })),
    skins: list(json, "skins").map((skin) => pick(skin, ["inverseBindMatrices", "joints", "skeleton"])),
    extensionsUsed: UNDERSTOOD,
  };
  const pictures = textures.map(({ source }, i) => {
    const image = images[source];
    const view = image === undefined ? undefined : views[image];
    if (view === undefined) throw new CheckError(`textures[${i}].source`, `there is no picture ${source}`);
    return binary.subarray(view.byteOffset, view.byteOffset + view.byteLength);
  });
  return { json: withoutEmpty(plain), binary, geometryBytes: geometryBytes(json), pictures };
}

function chunksOf(bytes: ArrayBuffer): { text: string; binary: Uint8Array<ArrayBuffer> } {
  const view = new DataView(bytes);
  if (bytes.byteLength < 20 || view.getUint32(0, true) !== MAGIC) throw new Error("it is not a GLB file");
  if (view.getUint32(4, true) !== 2) throw new Error(`it is GLB version ${view.getUint32(4, true)}, not 2`);
  const end = view.getUint32(8, true);
  const jsonBytes = view.getUint32(12, true);
  if (end > bytes.byteLength || 20 + jsonBytes > end) throw new Error("it is cut off");
  if (view.getUint32(16, true) !== JSON_CHUNK) throw new Error("it is damaged: its first part is not JSON");
  const text = new TextDecoder().decode(new Uint8Array(bytes, 20, jsonBytes));
  let binary = new Uint8Array(bytes, 0, 0);
  const at = 20 + jsonBytes;
  if (at + 8 <= end && view.getUint32(at + 4, true) === BIN_CHUNK) {
    const length = view.getUint32(at, true);
    if (at + 8 + length > end) throw new Error("it is cut off");
    binary = new Uint8Array(bytes, at + 8, length);
  }
  return { text, binary };
}

function refuseExtensions(json: JsonObject): void {
  const names = (key: string) =>
    asArray(json[key] ?? [], key, 1000).map((name, i) => asString(name, `${key}[${i}]`, 200));
  const packed = names("extensionsUsed").find((name) => PACKED.includes(name));
  if (packed !== undefined) throw new Error(`it is compressed (${packed}): export it without compression`);
  const unknown = names("extensionsRequired").find((name) => !UNDERSTOOD.includes(name));
  if (unknown !== undefined) throw new Error(`it needs the extension ${unknown}: export it without`);
}

function viewsOf(json: JsonObject, binary: Uint8Array): { byteOffset: number; byteLength: number }[] {
  const buffers = list(json, "buffers");
  if (buffers.length > 1 || buffers.some(({ uri }) => uri !== undefined)) throw notSelfContained();
  return list(json, "bufferViews").map((view, i) => {
    const path = `bufferViews[${i}]`;
    asInteger(view.buffer, `${path}.buffer`, 0, 0);
    const byteOffset = asInteger(view.byteOffset ?? 0, `${path}.byteOffset`, 0, binary.byteLength);
    const byteLength = asInteger(view.byteLength, `${path}.byteLength`, 0, binary.byteLength - byteOffset);
    return { buffer: 0, byteOffset, byteLength, ...pick(view, ["byteStride", "target"]) };
  });
}

function notSelfContained(): Error {
  return new Error("parts of it are in other files: export it as one self-contained GLB");
}

/** View of each picture. */
function imagesOf(json: JsonObject, views: number): number[] {
  return list(json, "images").map(({ uri, bufferView }, i) => {
    if (uri !== undefined || bufferView === undefined) throw notSelfContained();
    return asInteger(bufferView, `images[${i}].bufferView`, 0, views - 1);
  });
}

function nodesOf(json: JsonObject): JsonObject[] {
  const nodes = list(json, "nodes");
  if (nodes.length > MOST_NODES) throw new Error(`it has more than ${MOST_NODES} nodes`);
  const parents = new Set<number>();
  const children = (given: unknown, path: string): void => {
    for (const [k, child] of asArray(given ?? [], path, nodes.length).entries()) {
      const index = asInteger(child, `${path}[${k}]`, 0, nodes.length - 1);
      if (parents.has(index)) throw new CheckError(`${path}[${k}]`, `node ${index} is in two places`);
      parents.add(index);
    }
  };
  for (const [i, node] of nodes.entries()) children(node.children, `nodes[${i}].children`);
  // With one parent each, whatever begins at nodes without a parent has no circles.
  for (const [i, scene] of list(json, "scenes").entries()) {
    for (const [k, root] of asArray(scene.nodes ?? [], `scenes[${i}].nodes`, nodes.length).entries()) {
      const index = asInteger(root, `scenes[${i}].nodes[${k}]`, 0, nodes.length - 1);
      if (parents.has(index)) throw new CheckError(`scenes[${i}].nodes[${k}]`, `node ${index} is below another one`);
    }
  }
  const keys = ["children", "matrix", "translation", "rotation", "scale", "mesh", "skin", "weights"];
  return nodes.map((node) => pick(node, keys));
}

function meshesOf(json: JsonObject): JsonObject[] {
  let count = 0;
  return list(json, "meshes").map((mesh, i) => {
    const primitives = asArray(mesh.primitives, `meshes[${i}].primitives`, MOST_PRIMITIVES).map((given, k) => {
      const path = `meshes[${i}].primitives[${k}]`;
      const primitive = asObject(given, path);
      const attributes = pick(asObject(primitive.attributes, `${path}.attributes`), ATTRIBUTES);
      return { attributes, ...pick(primitive, ["indices", "material", "mode", "targets"]) };
    });
    count += primitives.length;
    if (count > MOST_PRIMITIVES) throw new Error(`it has more than ${MOST_PRIMITIVES} parts`);
    return { primitives, ...pick(mesh, ["weights"]) };
  });
}

/** Base colour and transparency; how it reflects is not shown. */
function plainMaterial(material: JsonObject, i: number): JsonObject {
  const path = `materials[${i}]`;
  const base = asObject(material.pbrMetallicRoughness ?? {}, `${path}.pbrMetallicRoughness`);
  const unlit = asObject(material.extensions ?? {}, `${path}.extensions`).KHR_materials_unlit !== undefined;
  return {
    pbrMetallicRoughness: pick(base, ["baseColorFactor", "baseColorTexture"]),
    ...pick(material, ["alphaMode", "alphaCutoff", "doubleSided"]),
    ...(unlit ? { extensions: { KHR_materials_unlit: {} } } : {}),
  };
}

function plainTexture(texture: JsonObject, path: string): { readonly source: number } & JsonObject {
  const extensions = asObject(texture.extensions ?? {}, `${path}.extensions`);
  const webp = extensions.EXT_texture_webp;
  const source = texture.source ?? (webp === undefined ? undefined : asObject(webp, path).source);
  return { ...pick(texture, ["sampler"]), source: asInteger(source, `${path}.source`, 0) };
}

/** What the arrays take once they are made, also those that the file leaves out because they are zeros. */
function geometryBytes(json: JsonObject): number {
  return list(json, "accessors").reduce((sum, accessor, i) => {
    const path = `accessors[${i}]`;
    const count = asNumber(accessor.count, `${path}.count`, 0);
    const size = COMPONENT_BYTES[asInteger(accessor.componentType, `${path}.componentType`)];
    const components = COMPONENTS[asString(accessor.type, `${path}.type`, 10)];
    if (size === undefined || components === undefined) throw new CheckError(path, "its type is unknown");
    return sum + count * size * components;
  }, 0);
}

function list(json: JsonObject, key: string): JsonObject[] {
  return asArray(json[key] ?? [], key).map((entry, i) => asObject(entry, `${key}[${i}]`));
}

function pick(from: JsonObject, keys: readonly string[]): JsonObject {
  return Object.fromEntries(keys.filter((key) => from[key] !== undefined).map((key) => [key, from[key]]));
}

/** The format allows no empty lists. */
function withoutEmpty(json: JsonObject): JsonObject {
  return Object.fromEntries(Object.entries(json).filter(([, value]) => !Array.isArray(value) || value.length > 0));
}
