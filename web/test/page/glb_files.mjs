// Small GLB files for the checks of the page.
import { PNG } from "pngjs";

/** A GLB of a box that stands on its origin; `size` along x, y (up) and z. */
export function boxGlb([x, y, z], color) {
  const corners = [];
  for (const side of [0, 1, 2]) {
    for (const sign of [-1, 1]) {
      const [u, v] = [(side + 1) % 3, (side + 2) % 3];
      const quad = [
        [-1, -1],
        [1, -1],
        [1, 1],
        [-1, 1],
      ].map(([a, b]) => {
        const corner = [0, 0, 0];
        corner[side] = sign;
        corner[u] = a * sign;
        corner[v] = b;
        return [(corner[0] * x) / 2, ((corner[1] + 1) * y) / 2, (corner[2] * z) / 2];
      });
      for (const k of [0, 1, 2, 0, 2, 3]) corners.push(...quad[k]);
    }
  }
  return triangles(corners, { pbrMetallicRoughness: { baseColorFactor: [...color, 1] } });
}

/** A square of 1 x 1 on its origin, upright and seen from both sides, with a picture of one colour (display values) and without light. */
export function signGlb([r, g, b]) {
  const picture = new PNG({ width: 2, height: 2 });
  for (let i = 0; i < 4; i += 1) picture.data.set([r, g, b, 255], 4 * i);
  const [low, high] = [-0.5, 0.5];
  const quad = [low, 0, 0, high, 0, 0, high, 1, 0, low, 0, 0, high, 1, 0, low, 1, 0];
  const material = {
    pbrMetallicRoughness: { baseColorTexture: { index: 0 } },
    doubleSided: true,
    extensions: { KHR_materials_unlit: {} },
  };
  const uvs = [0, 1, 1, 1, 1, 0, 0, 1, 1, 0, 0, 0];
  return triangles(quad, material, { uvs, png: PNG.sync.write(picture) });
}

function triangles(positions, material, textured) {
  const parts = [Buffer.from(Float32Array.from(positions).buffer)];
  if (textured !== undefined) parts.push(Buffer.from(Float32Array.from(textured.uvs).buffer), textured.png);
  let at = 0;
  const bufferViews = parts.map((part) => {
    const view = { buffer: 0, byteOffset: at, byteLength: part.length };
    at += part.length;
    return view;
  });
  const axis = (i) => positions.filter((_, k) => k % 3 === i);
  const [x, y, z] = [axis(0), axis(1), axis(2)];
  const count = positions.length / 3;
  const accessors = [
    {
      bufferView: 0,
      componentType: 5126,
      count,
      type: "VEC3",
      min: [Math.min(...x), Math.min(...y), Math.min(...z)],
      max: [Math.max(...x), Math.max(...y), Math.max(...z)],
    },
  ];
  const attributes = { POSITION: 0 };
  const document = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes, material: 0 }] }],
    materials: [material],
    accessors,
    bufferViews,
    buffers: [{ byteLength: at }],
  };
  if (textured !== undefined) {
    attributes.TEXCOORD_0 = 1;
    accessors.push({ bufferView: 1, componentType: 5126, count, type: "VEC2" });
    document.images = [{ bufferView: 2, mimeType: "image/png" }];
    document.textures = [{ source: 0 }];
    document.extensionsUsed = ["KHR_materials_unlit"];
  }
  return glb(document, Buffer.concat(parts));
}

function glb(document, binary) {
  const text = JSON.stringify(document);
  const chunk = (type, bytes, filler) => {
    const body = Buffer.alloc(Math.ceil(bytes.length / 4) * 4, filler);
    bytes.copy(body);
    const head = Buffer.alloc(8);
    head.writeUInt32LE(body.length, 0);
    head.write(type, 4, "latin1");
    return Buffer.concat([head, body]);
  };
  const chunks = Buffer.concat([chunk("JSON", Buffer.from(text), " "), chunk("BIN\0", binary, 0)]);
  const head = Buffer.alloc(12);
  head.write("glTF", 0, "latin1");
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + chunks.length, 8);
  return Buffer.concat([head, chunks]);
}
