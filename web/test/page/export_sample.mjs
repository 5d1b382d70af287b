// Writes the folder of a small exported tour whose pictures say in which direction each pixel looks: red east, green north, blue up. Two stops stand 40 m
// above a flat ground of one tile, and look at it.
import { createHash } from "node:crypto";
import { cpSync, mkdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import { deflateRawSync } from "node:zlib";
import { PNG } from "pngjs";

export const STILL = { width: 400, height: 250 };
const PANORAMA = { width: 1024, height: 512 };
const FOVY_DEG = 50;
const HALF_SIDE_M = 150;
/** Of the ground's texture. */
export const GROUND = [200, 60, 20];
/** Of a plate of 3 m at the second stop. */
export const MODEL_AT = [10, 10, 3];
const RANGE = { near: 20, far: 2000 };
const DEG = Math.PI / 180;

/** cam_from_enu (w, x, y, z) of a level camera. */
export function rotationOf(yawDeg, pitchDeg) {
  const [yaw, pitch] = [yawDeg * DEG, pitchDeg * DEG];
  const ahead = [Math.sin(yaw) * Math.cos(pitch), Math.cos(yaw) * Math.cos(pitch), Math.sin(pitch)];
  const right = [Math.cos(yaw), -Math.sin(yaw), 0];
  const down = [
    ahead[1] * right[2] - ahead[2] * right[1],
    ahead[2] * right[0] - ahead[0] * right[2],
    ahead[0] * right[1] - ahead[1] * right[0],
  ];
  const m = [right, down, ahead];
  // Of the four ways to take the quaternion out of the matrix the one with the largest number under the root.
  const squares = [
    1 + m[0][0] + m[1][1] + m[2][2],
    1 + m[0][0] - m[1][1] - m[2][2],
    1 - m[0][0] + m[1][1] - m[2][2],
    1 - m[0][0] - m[1][1] + m[2][2],
  ];
  const largest = squares.indexOf(Math.max(...squares));
  const q = [
    [squares[0], m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]],
    [m[2][1] - m[1][2], squares[1], m[1][0] + m[0][1], m[0][2] + m[2][0]],
    [m[0][2] - m[2][0], m[1][0] + m[0][1], squares[2], m[2][1] + m[1][2]],
    [m[1][0] - m[0][1], m[0][2] + m[2][0], m[2][1] + m[1][2], squares[3]],
  ][largest];
  const length = Math.hypot(...q);
  return q.map((value) => value / length);
}

/** ENU direction, of length 1, through a place of a picture of this size. */
export function rayOf([w, x, y, z], fovyDeg, { width, height }, px) {
  const focal = height / 2 / Math.tan((fovyDeg / 2) * DEG);
  const v = [(px[0] - width / 2) / focal, (px[1] - height / 2) / focal, 1];
  const q = [-x, -y, -z];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const t = cross(q, v).map((value) => 2 * value);
  const u = cross(q, t);
  const length = Math.hypot(...v);
  return v.map((value, i) => (value + w * t[i] + u[i]) / length);
}

export function colourOf(direction) {
  return direction.map((value) => Math.round(127.5 + 127 * value));
}

function paint({ width, height }, colour) {
  const picture = new PNG({ width, height });
  for (let row = 0; row < height; row += 1) {
    for (let column = 0; column < width; column += 1) {
      picture.data.set([...colour(column, row), 255], 4 * (row * width + column));
    }
  }
  return picture;
}

/** With a pattern of single pixels, which nothing but the still itself has. */
export function stillOf(stop) {
  const { rotation, fovy_deg } = stop.pose;
  return paint(STILL, (column, row) => {
    const [red, green, blue] = colourOf(rayOf(rotation, fovy_deg, STILL, [column + 0.5, row + 0.5]));
    return [red, green, (column + row) % 2 === 0 ? blue : 255 - blue];
  });
}

function directionAt(column, row) {
  const azimuth = ((column + 0.5) / PANORAMA.width - 0.5) * 360 * DEG;
  const elevation = (0.5 - (row + 0.5) / PANORAMA.height) * 180 * DEG;
  return [Math.sin(azimuth) * Math.cos(elevation), Math.cos(azimuth) * Math.cos(elevation), Math.sin(elevation)];
}

/** Half as large as its picture; 0: no surface. */
function depthFile({ width, height }, depthAt) {
  const [columns, rows] = [Math.ceil(width / 2), Math.ceil(height / 2)];
  const bytes = Buffer.alloc(2 * columns * rows);
  for (let j = 0; j < rows; j += 1) {
    for (let i = 0; i < columns; i += 1) {
      const depth = depthAt(2 * i, 2 * j);
      if (!(depth >= RANGE.near && depth <= RANGE.far)) continue;
      const share = (1 / depth - 1 / RANGE.far) / (1 / RANGE.near - 1 / RANGE.far);
      bytes.writeUInt16LE(1 + Math.round(65534 * share), 2 * (j * columns + i));
    }
  }
  return deflateRawSync(bytes);
}

function padded(bytes, filler) {
  return Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4, filler)]);
}

/** A square of the ground with its texture inside, y up. */
function groundTile() {
  const picture = PNG.sync.write(paint({ width: 64, height: 64 }, () => GROUND));
  const s = HALF_SIDE_M;
  const parts = [
    Buffer.from(new Float32Array([-s, 0, s, s, 0, s, s, 0, -s, -s, 0, -s]).buffer),
    Buffer.from(new Float32Array([0, 1, 1, 1, 1, 0, 0, 0]).buffer),
    Buffer.from(new Uint16Array([0, 1, 2, 0, 2, 3]).buffer),
    padded(picture, 0),
  ];
  const lengths = [48, 32, 12, picture.length];
  let at = 0;
  const bufferViews = parts.map((part, i) => {
    const view = { buffer: 0, byteOffset: at, byteLength: lengths[i] };
    at += part.length;
    return view;
  });
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } }, extensions: { KHR_materials_unlit: {} } }],
    extensionsUsed: ["KHR_materials_unlit"],
    textures: [{ source: 0 }],
    images: [{ bufferView: 3, mimeType: "image/png" }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [-s, 0, -s], max: [s, 0, s] },
      { bufferView: 1, componentType: 5126, count: 4, type: "VEC2" },
      { bufferView: 2, componentType: 5123, count: 6, type: "SCALAR" },
    ],
    bufferViews,
    buffers: [{ byteLength: at }],
  };
  const text = padded(Buffer.from(JSON.stringify(json)), 0x20);
  const words = (...values) => Buffer.from(new Uint32Array(values).buffer);
  return Buffer.concat([
    words(0x46546c67, 2, 12 + 8 + text.length + 8 + at),
    words(text.length, 0x4e4f534a),
    text,
    words(at, 0x004e4942),
    ...parts,
  ]);
}

/** The same ground as a grid of points, for ways and the map. */
function terrain() {
  const side = 31;
  const bytes = Buffer.alloc(40 + 12 * side * side);
  bytes.write("SKYTERR1", 0, "latin1");
  bytes.writeUInt32LE(side, 8);
  bytes.writeUInt32LE(side, 12);
  for (let row = 0; row < side; row += 1) {
    for (let column = 0; column < side; column += 1) {
      const at = 40 + 12 * (row * side + column);
      bytes.writeFloatLE(((2 * column) / (side - 1) - 1) * HALF_SIDE_M, at);
      bytes.writeFloatLE((1 - (2 * row) / (side - 1)) * HALF_SIDE_M, at + 4);
    }
  }
  return bytes;
}

function project() {
  const side = HALF_SIDE_M;
  return {
    name: "sample",
    revision: 1,
    georeferenced: false,
    origin: { latitude_deg: 0, longitude_deg: 0, height_m: 0 },
    crs: null,
    vertical: "",
    accuracy: null,
    min_enu: [-side, -side, -1],
    max_enu: [side, side, 60],
    ground_m: 0,
    gsd_m: 0.1,
    scene: null,
    tiles: "tiles/tileset.json",
    terrain: "terrain.bin",
    orthophoto: "orthophoto.jpg",
    points: null,
    contours: null,
    surface: null,
    buildings: null,
    blocks: [],
    cameras: [],
    photos: [],
    metrics: null,
    missing: [],
    before: null,
  };
}

function stop(id, title, eye, yawDeg, picture) {
  return {
    id,
    title,
    text: "Line 1\nLine 2 <b>not bold</b>",
    picture,
    link: { label: "More", url: "https://example.org/" },
    pose: { eye_enu: eye, rotation: rotationOf(yawDeg, -35), fovy_deg: FOVY_DEG },
    exposure_stops: null,
    layers: null,
    measurements: [],
    pause_s: 1,
    next: { to: null, path: { kind: "direct" } },
    branches: [],
  };
}

/** `encodeJpeg` makes a JPEG of a PNG of pngjs. Returns the stops. */
export async function writeSample(folder, dist, encodeJpeg) {
  const card = PNG.sync.write(paint({ width: 40, height: 30 }, (column) => [column * 6, 90, 200]));
  const model = groundTile();
  const digest = (bytes) => createHash("sha256").update(bytes).digest("hex");
  const asset = `${digest(card)}.png`;
  const modelAsset = `${digest(model)}.glb`;
  const stops = [
    stop("south", "<script>document.title = 'run'</script>", [0, -60, 40], 0, asset),
    stop("east", "Østen 東", [60, 20, 40], 250, null),
  ];
  const tour = {
    version: 1,
    title: "A <i>small</i> tour",
    start: null,
    stops,
    things: [
      { id: "l1", kind: "label", at: [0, 0, 1], text: "Middle", stops: null },
      {
        id: "m1",
        kind: "model",
        at: MODEL_AT,
        yaw_deg: 0,
        scale: 0.01,
        name: "plate",
        asset: modelAsset,
        stops: ["east"],
      },
    ],
    assets: {
      [asset]: { name: "card.png", bytes: card.length },
      [modelAsset]: { name: "plate.glb", bytes: model.length },
    },
  };
  const size = ({ width, height }) => ({
    width,
    height,
    ...RANGE,
    depth_width: Math.ceil(width / 2),
    depth_height: Math.ceil(height / 2),
  });
  const round = await encodeJpeg(paint(PANORAMA, (column, row) => colourOf(directionAt(column, row))));
  const files = {
    "project.json": JSON.stringify(project()),
    "tour.json": JSON.stringify(tour),
    "tiles/tileset.json": JSON.stringify({
      asset: { version: "1.1" },
      geometricError: 10,
      root: {
        boundingVolume: { box: [0, 0, 0, HALF_SIDE_M, 0, 0, 0, HALF_SIDE_M, 0, 0, 0, 1] },
        geometricError: 0,
        refine: "REPLACE",
        content: { uri: "ground.glb" },
      },
    }),
    "tiles/ground.glb": groundTile(),
    "terrain.bin": terrain(),
    "orthophoto.jpg": await encodeJpeg(paint({ width: 60, height: 60 }, () => GROUND)),
    [`assets/${asset}`]: card,
    [`assets/${modelAsset}`]: model,
  };
  for (const { id, pose } of stops) {
    const eye = pose.eye_enu;
    const downTo = (direction) => (direction[2] < 0 ? -eye[2] / direction[2] : Number.NaN);
    const ahead = rayOf(pose.rotation, FOVY_DEG, STILL, [STILL.width / 2, STILL.height / 2]);
    const inStill = (column, row) => rayOf(pose.rotation, FOVY_DEG, STILL, [column + 0.5, row + 0.5]);
    const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
    files[`stops/${id}/still.png`] = PNG.sync.write(stillOf({ pose }));
    files[`stops/${id}/still.depth`] = depthFile(STILL, (column, row) => {
      const ray = inStill(column, row);
      return downTo(ray) * dot(ray, ahead);
    });
    files[`stops/${id}/panorama.jpg`] = round;
    files[`stops/${id}/panorama.depth`] = depthFile(PANORAMA, (column, row) => downTo(directionAt(column, row)));
  }
  files["manifest.json"] = JSON.stringify({
    version: 1,
    missing: ['The model "tree" is left out.'],
    stops: Object.fromEntries(
      stops.map(({ id }) => [id, { still: { ...size(STILL), image: "png" }, panorama: size(PANORAMA) }]),
    ),
    files: [...Object.keys(files), "manifest.json"],
    made_by: "skyquilt",
    date: "2026-01-01",
  });
  for (const [name, bytes] of Object.entries(files)) {
    const file = path.join(folder, "data", `${name}.js`);
    mkdirSync(path.dirname(file), { recursive: true });
    writeFileSync(file, `skyquiltData(${JSON.stringify(name)},"${Buffer.from(bytes).toString("base64")}")\n`);
  }
  for (const name of ["tour.js", "tour.css"]) cpSync(path.join(dist, name), path.join(folder, name));
  cpSync(path.join(dist, "tour.html"), path.join(folder, "index.html"));
  writeFileSync(
    path.join(folder, "poster.jpg"),
    await encodeJpeg(paint({ width: 80, height: 50 }, () => [40, 60, 80])),
  );
  return stops;
}
