// Files of models: what is read, what is refused, and what becomes of a good one.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Color, Mesh, MeshBasicMaterial, MeshLambertMaterial, type Object3D } from "three";
import { readGlb } from "../../../src/scene/glb_document.js";
import { imageSize } from "../../../src/scene/image_size.js";
import { readModel } from "../../../src/scene/model_file.js";
import { glb, pngHeader, TRIANGLE, triangleDocument, triangleGlb } from "./glb_samples.js";

function refused(patch: Record<string, unknown>, why: RegExp): void {
  assert.throws(() => readGlb(triangleGlb(patch)), why);
}

function meshesOf(object: Object3D): Mesh[] {
  const meshes: Mesh[] = [];
  object.traverse((child) => {
    if (child instanceof Mesh) meshes.push(child);
  });
  return meshes;
}

test("only whole GLB files of version 2 are read", () => {
  const good = triangleGlb();
  assert.doesNotThrow(() => readGlb(good));
  for (const length of [0, 11, 19, 40, good.byteLength - 1]) {
    assert.throws(() => readGlb(good.slice(0, length)), /not a GLB|cut off/, `${length} bytes`);
  }
  const other = good.slice(0);
  new DataView(other).setUint32(4, 1, true);
  assert.throws(() => readGlb(other), /version 1/);
  assert.throws(() => readGlb(new TextEncoder().encode("<script>alert(1)</script>").buffer), /not a GLB/);
  assert.throws(() => readGlb(new ArrayBuffer(51 * 2 ** 20)), /larger than 50 MiB/);
});

test("everything must be in the file itself", () => {
  refused({ buffers: [{ byteLength: 36, uri: "other.bin" }] }, /other files/);
  refused({ buffers: [{ byteLength: 36, uri: "data:application/octet-stream;base64,AAAA" }] }, /other files/);
  refused({ buffers: [{ byteLength: 36 }, { byteLength: 36 }] }, /other files/);
  refused({ images: [{ uri: "https://example.org/a.png" }] }, /other files/);
  refused({ images: [{ uri: "data:image/png;base64,AAAA" }] }, /other files/);
  refused({ bufferViews: [{ buffer: 0, byteOffset: 8, byteLength: 36 }] }, /bufferViews\[0\]\.byteLength/);
});

test("what needs another decoder is refused by name, what is only decoration is not", () => {
  refused({ extensionsUsed: ["KHR_draco_mesh_compression"] }, /compressed \(KHR_draco_mesh_compression\)/);
  refused({ extensionsRequired: ["KHR_texture_basisu"] }, /needs the extension KHR_texture_basisu/);
  const decorated = triangleGlb({ extensionsUsed: ["KHR_materials_clearcoat", "KHR_lights_punctual"] });
  assert.doesNotThrow(() => readGlb(decorated));
});

test("nodes must be a tree", () => {
  refused({ nodes: [{ mesh: 0, children: [1] }, { children: [0] }] }, /nodes/);
  refused({ nodes: [{ children: [1, 1] }, { mesh: 0 }] }, /in two places/);
  refused({ nodes: [{ children: [0] }], scenes: [{ nodes: [0] }] }, /below another/);
  refused({ nodes: [{ children: [7] }] }, /children\[0\]/);
});

test("memory is counted before anything is made, also that of arrays which the file leaves out", () => {
  assert.equal(readGlb(triangleGlb()).geometryBytes, 36);
  const bomb = { accessors: [{ componentType: 5126, count: 1e9, type: "VEC3" }] };
  assert.equal(readGlb(triangleGlb(bomb)).geometryBytes, 12e9);
  const picture = pngHeader(10_000, 4096);
  const document = triangleDocument({
    textures: [{ source: 0 }],
    images: [{ bufferView: 1, mimeType: "image/png" }],
    bufferViews: [
      { buffer: 0, byteLength: 36 },
      { buffer: 0, byteOffset: 36, byteLength: picture.length },
    ],
  });
  const binary = new Uint8Array(36 + picture.length);
  binary.set(new Uint8Array(TRIANGLE.buffer));
  binary.set(picture, 36);
  // Larger pictures are made 4096 pixels long.
  const pixels = 4096 * 1678;
  const { bytes } = readModel(glb(document, binary), true);
  assert.ok(Math.abs(bytes - 72 - (28 / 3) * pixels) < 1, `${bytes} bytes`);
  binary.set(pngHeader(20_000, 1), 36);
  assert.throws(() => readModel(glb(document, binary), true), /20000 x 1 pixels/);
  binary.fill(0, 36);
  assert.throws(() => readModel(glb(document, binary), true), /neither PNG, JPEG nor WebP/);
});

test("sizes of pictures", () => {
  assert.deepEqual(imageSize(pngHeader(640, 480)), [640, 480]);
  // APP0, a table, a frame with progressive coding.
  const jpeg = [
    0xff, 0xd8, 0xff, 0xe0, 0, 4, 1, 2, 0xff, 0xc4, 0, 3, 9, 0xff, 0xff, 0xc2, 0, 11, 8, 1, 0xe0, 2, 0x80, 3,
  ];
  assert.deepEqual(imageSize(Uint8Array.from(jpeg)), [640, 480]);
  assert.equal(imageSize(Uint8Array.from(jpeg.slice(0, 19))), null);
  const webp = (kind: string, rest: readonly number[]) =>
    Uint8Array.from([..."RIFF____WEBP", ...kind, ..."____"].map((letter) => letter.charCodeAt(0)).concat(rest));
  assert.deepEqual(imageSize(webp("VP8X", [0, 0, 0, 0, 0x7f, 2, 0, 0xdf, 1, 0])), [640, 480]);
  assert.deepEqual(imageSize(webp("VP8L", [0x2f, 0x7f, 0xc2, 0x77, 0])), [640, 480]);
  assert.deepEqual(imageSize(webp("VP8 ", [0, 0, 0, 0x9d, 1, 0x2a, 0x80, 2, 0xe0, 1])), [640, 480]);
  assert.equal(imageSize(new TextEncoder().encode("GIF89a")), null);
  assert.equal(imageSize(new Uint8Array(0)), null);
});

test("a good file becomes a model in its own axes with its base colour as a display value", async () => {
  const model = await readModel(triangleGlb(), true).make();
  assert.deepEqual(model.box, { min: [0, 0, -4], max: [2, 3, 0] });
  const [mesh] = meshesOf(model.object);
  assert.ok(mesh?.material instanceof MeshLambertMaterial);
  // 0.5 of the light is 188 of 255 on a screen.
  assert.ok(Math.abs(mesh.material.color.r - 188 / 255) < 0.002, `${mesh.material.color.r}`);
  assert.equal(mesh.material.color.g, 0);
  assert.ok(mesh.material.flatShading, "without normals its faces are flat");
});

test("lights and cameras of a file are left out, unlit materials stay unlit", async () => {
  const model = await readModel(
    triangleGlb({
      nodes: [
        { mesh: 0, children: [1] },
        { camera: 0, extensions: { KHR_lights_punctual: { light: 0 } } },
      ],
      cameras: [{ type: "perspective", perspective: { yfov: 1, znear: 0.1 } }],
      extensionsUsed: ["KHR_materials_unlit", "KHR_lights_punctual"],
      extensions: { KHR_lights_punctual: { lights: [{ type: "point" }] } },
      materials: [{ extensions: { KHR_materials_unlit: {} } }],
    }),
    true,
  ).make();
  const kinds = new Set<string>();
  model.object.traverse(({ type }) => kinds.add(type));
  assert.ok(![...kinds].some((kind) => /Light|Camera/.test(kind)), [...kinds].join());
  assert.ok(meshesOf(model.object)[0]?.material instanceof MeshBasicMaterial);
});

test("bones stand still where they are", async () => {
  // Two bones; all vertices follow the second, which is moved up by 10.
  const binary = new Uint8Array(36 + 12 + 48);
  binary.set(new Uint8Array(TRIANGLE.buffer));
  binary.set(new Uint8Array(Uint8Array.from([1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])), 36);
  binary.set(new Uint8Array(Float32Array.from([1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]).buffer), 48);
  const document = triangleDocument({
    scenes: [{ nodes: [0, 1, 2] }],
    nodes: [{ mesh: 0, skin: 0 }, {}, { translation: [0, 10, 0] }],
    skins: [{ joints: [1, 2] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, JOINTS_0: 1, WEIGHTS_0: 2 } }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, -4], max: [2, 3, 0] },
      { bufferView: 1, componentType: 5121, count: 3, type: "VEC4" },
      { bufferView: 2, componentType: 5126, count: 3, type: "VEC4" },
    ],
    bufferViews: [
      { buffer: 0, byteLength: 36 },
      { buffer: 0, byteOffset: 36, byteLength: 12 },
      { buffer: 0, byteOffset: 48, byteLength: 48 },
    ],
  });
  const model = await readModel(glb(document, binary), true).make();
  assert.deepEqual(model.box, { min: [0, 10, -4], max: [2, 13, 0] });
  assert.ok(meshesOf(model.object).every((mesh) => !("skeleton" in mesh)));
});

test("numbers that are none, and files with nothing to see, are errors", async () => {
  const broken = TRIANGLE.slice();
  broken[4] = Number.NaN;
  await assert.rejects(readModel(triangleGlb({}, broken), true).make(), /not a number/);
  await assert.rejects(readModel(triangleGlb({ nodes: [{}] }), true).make(), /nothing to see/);
});

test("vertex colours become display values", async () => {
  const binary = new Uint8Array(72);
  binary.set(new Uint8Array(TRIANGLE.buffer));
  binary.set(new Uint8Array(Float32Array.from([0.5, 0, 1, 0.5, 0, 1, 0.5, 0, 1]).buffer), 36);
  const document = triangleDocument({
    meshes: [{ primitives: [{ attributes: { POSITION: 0, COLOR_0: 1 } }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, -4], max: [2, 3, 0] },
      { bufferView: 1, componentType: 5126, count: 3, type: "VEC3" },
    ],
    bufferViews: [
      { buffer: 0, byteLength: 36 },
      { buffer: 0, byteOffset: 36, byteLength: 36 },
    ],
  });
  const model = await readModel(glb(document, binary), true).make();
  const color = meshesOf(model.object)[0]?.geometry.getAttribute("color");
  assert.ok(color !== undefined && Math.abs(color.getX(2) - new Color(0.5, 0, 1).convertLinearToSRGB().r) < 1e-6);
});
