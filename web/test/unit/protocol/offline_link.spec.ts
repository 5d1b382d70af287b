import assert from "node:assert/strict";
import test from "node:test";
import { deflateRawSync, inflateRawSync } from "node:zlib";
import { ManualClock } from "../../../src/base/clock.js";
import { rotationFromAngles } from "../../../src/geo/camera.js";
import type { DecodedFrame } from "../../../src/protocol/link_platform.js";
import { OfflineLink, type OfflinePlatform, type PicturePlace } from "../../../src/protocol/offline_link.js";
import { StopPictureStore } from "../../../src/protocol/stop_pictures.js";
import { readTourManifest } from "../../../src/protocol/tour_manifest.js";

const LEVEL = rotationFromAngles({ yawDeg: 40, pitchDeg: 0, rollDeg: 0 });
const TURNED = rotationFromAngles({ yawDeg: 90, pitchDeg: -10, rollDeg: 0 });
const STOPS = [
  { id: "a", eyeEnu: [1, 2, 30], rotation: LEVEL, fovyDeg: 50 },
  { id: "b", eyeEnu: [50, 2, 30], rotation: LEVEL, fovyDeg: 50 },
] as const;
const RANGE = { near: 5, far: 500 };

/** Depths of one value, near or far. */
function depthFile(count: number, value: 1 | 65535): Buffer {
  const bytes = Buffer.alloc(2 * count);
  for (let i = 0; i < count; i += 1) bytes.writeUInt16LE(value, 2 * i);
  return deflateRawSync(bytes);
}

/** A picture stands for its size and what was done to it. */
class Picture {
  readonly what: string;
  readonly width: number;
  readonly height: number;
  closed = false;

  constructor(what: string, width: number, height: number) {
    this.what = what;
    this.width = width;
    this.height = height;
  }

  close(): void {
    this.closed = true;
  }
}

interface Setup {
  readonly stillDepth?: boolean;
  readonly panorama?: boolean;
  /** Names of files that are not there. */
  readonly lost?: readonly string[];
}

function setup({ stillDepth = true, panorama = true, lost = [] }: Setup = {}) {
  const half = (count: number, there: boolean) => (there ? Math.ceil(count / 2) : 0);
  const still = {
    width: 160,
    height: 90,
    image: "jpg",
    ...(stillDepth ? RANGE : { near: 0, far: 0 }),
    depth_width: half(160, stillDepth),
    depth_height: half(90, stillDepth),
  };
  const round = { width: 256, height: 128, ...RANGE, depth_width: 128, depth_height: 64 };
  const manifest = readTourManifest({
    version: 1,
    missing: [],
    stops: { a: { still, panorama: panorama ? round : null }, b: { still, panorama: null } },
  });
  const loads: string[] = [];
  const failed: string[] = [];
  const made: Picture[] = [];
  const places: PicturePlace[] = [];
  const make = (what: string, width: number, height: number) => {
    const picture = new Picture(what, width, height);
    made.push(picture);
    return picture;
  };
  const files = {
    load: async (name: string): Promise<Uint8Array<ArrayBuffer>> => {
      loads.push(name);
      if (lost.includes(name)) throw new Error(`${name} is not there`);
      if (name.endsWith("still.depth")) return new Uint8Array(depthFile(80 * 45, 65535));
      if (name.endsWith("panorama.depth")) return new Uint8Array(depthFile(128 * 64, 1));
      return new Uint8Array(1);
    },
    release: () => {},
  };
  const platform: OfflinePlatform<Picture> = {
    clock: new ManualClock(),
    decode: async () => make("still", 160, 90),
    compose: async (width, height, under, over) => {
      if (over !== null) {
        assert.ok(!over.bitmap.closed);
        places.push(over.place);
      }
      return make([under && "panorama", over && "over"].filter(Boolean).join(" "), width, height);
    },
    pause: async () => {},
    failed: (text) => failed.push(text),
  };
  const pictures = new StopPictureStore({
    sizes: manifest.stops,
    files,
    inflate: async (packed, bytes) => new Uint8Array(inflateRawSync(packed)).subarray(0, bytes + 1),
    pixels: async () => ({ width: 256, height: 128, rgba: new Uint8ClampedArray(4 * 256 * 128) }),
    failed: (text) => failed.push(text),
  });
  const link = new OfflineLink<Picture>(STOPS, pictures, platform);
  const frames: DecodedFrame<Picture>[] = [];
  link.onFrame((frame) => frames.push(frame));
  return { link, frames, failed, loads, made, places };
}

const VIEW = {
  project: "main",
  eyeEnu: STOPS[0].eyeEnu,
  rotation: LEVEL,
  fovyDeg: 50,
  orthoHeightM: null,
  w: 160,
  h: 90,
} as const;

async function quiet(): Promise<void> {
  for (let i = 0; i < 50; i += 1) await new Promise((done) => setImmediate(done));
}

test("from a stop's own pose its still comes unchanged, with its depth", async () => {
  const { link, frames, made } = setup();
  const seq = link.view({ ...VIEW, eyeEnu: [1, 2 + 1e-7, 30], rotation: [-LEVEL[0], -LEVEL[1], -LEVEL[2], -LEVEL[3]] });
  await quiet();
  assert.equal(frames.length, 1);
  const frame = frames[0];
  assert.ok(frame !== undefined);
  assert.deepEqual(
    [frame.seq, frame.pass, frame.passes, frame.width, frame.height, frame.bitmap.what],
    [seq, 0, 1, 160, 90, "still"],
  );
  assert.deepEqual([frame.depthWidth, frame.depthHeight], [80, 45]);
  assert.ok(frame.depthM.every((z) => Math.abs(z - 5) < 1e-3));
  assert.equal(made.length, 1);
});

test("another canvas gets the still scaled and cut, but no more pixels than it has", async () => {
  const { link, frames, made } = setup();
  link.view({ ...VIEW, w: 80, h: 50 });
  await quiet();
  link.view({ ...VIEW, w: 320, h: 180 });
  await quiet();
  assert.deepEqual(
    frames.map(({ width, height, bitmap }) => [width, height, bitmap.what]),
    [
      [80, 50, "over"],
      [160, 90, "still"],
    ],
  );
  // What was decoded to be scaled is closed; what was shown is the listener's.
  assert.deepEqual(
    made.map(({ closed }) => closed),
    [true, false, false],
  );
});

test("where the still is only cut, its pixels stay on whole pixels", async () => {
  const { link, frames, places } = setup();
  for (const [w, h] of [
    [311, 180],
    [640, 410],
    [201, 270],
  ] as const) {
    link.view({ ...VIEW, w, h });
    await quiet();
  }
  assert.deepEqual(
    frames.map(({ width, height }) => [width, height]),
    [
      [156, 90],
      [140, 90],
      [68, 90],
    ],
  );
  for (const { left, top, width, height } of places) {
    assert.ok(Math.abs(left - Math.round(left)) < 1e-9 && Math.abs(top) < 1e-9, `${left} ${top}`);
    assert.ok(Math.abs(width - 160) < 1e-9 && Math.abs(height - 90) < 1e-9, `${width} ${height}`);
  }
});

test("a wider canvas has the panorama beside the still, and both depths", async () => {
  const { link, frames } = setup();
  link.view({ ...VIEW, w: 240, h: 90 });
  await quiet();
  const frame = frames[0];
  assert.ok(frame !== undefined && frames.length === 1);
  assert.deepEqual([frame.width, frame.bitmap.what], [240, "panorama over"]);
  const z = (column: number) => frame.depthM[20 * 120 + column] ?? 0;
  assert.ok(Math.abs(z(60) - 5) < 1e-3 && z(0) > 300, `${z(60)} ${z(0)}`);
});

test("another direction at the stop is cut from the panorama, in as many pixels as that has", async () => {
  const { link, frames, loads } = setup();
  link.view({ ...VIEW, rotation: TURNED, w: 1600, h: 900 });
  await quiet();
  const frame = frames[0];
  assert.ok(frame !== undefined && frames.length === 1);
  assert.equal(frame.bitmap.what, "panorama");
  assert.ok(
    frame.height < 100 && Math.abs(frame.width / frame.height - 16 / 9) < 0.03,
    `${frame.width} x ${frame.height}`,
  );
  assert.deepEqual(loads, ["stops/a/panorama.jpg", "stops/a/panorama.depth"]);
  assert.deepEqual([frame.rotation, frame.fovyDeg, frame.eyeEnu], [TURNED, 50, VIEW.eyeEnu]);
});

test("elsewhere, without pictures, and without perspective nothing comes", async () => {
  const { link, frames, failed } = setup();
  for (const view of [
    { ...VIEW, eyeEnu: [1, 2.01, 30] as const },
    { ...VIEW, fovyDeg: null, orthoHeightM: 50 },
    { ...VIEW, project: "before" as const },
    // The other stop has no panorama.
    { ...VIEW, eyeEnu: STOPS[1].eyeEnu, rotation: TURNED },
  ]) {
    link.view(view);
    await quiet();
  }
  assert.deepEqual([frames, failed], [[], []]);
});

test("a still without depths is shown at once, and gets those of the panorama", async () => {
  const { link, frames } = setup({ stillDepth: false });
  link.view(VIEW);
  await quiet();
  assert.deepEqual(
    frames.map(({ pass, passes, depthWidth }) => [pass, passes, depthWidth]),
    [
      [0, 2, 0],
      [1, 2, 80],
    ],
  );
  assert.ok(frames[1]?.depthM.every((z) => z > 200));
  assert.equal(frames[1]?.bitmap.what, "still");
  const alone = setup({ stillDepth: false, panorama: false });
  alone.link.view(VIEW);
  await quiet();
  assert.deepEqual(
    alone.frames.map(({ pass, passes, depthWidth }) => [pass, passes, depthWidth]),
    [[0, 1, 0]],
  );
});

test("only the newest view is answered, and none after stop()", async () => {
  const { link, frames, made } = setup();
  link.view({ ...VIEW, rotation: TURNED });
  const newest = link.view(VIEW);
  await quiet();
  assert.deepEqual(
    frames.map(({ seq }) => seq),
    [newest],
  );
  link.view({ ...VIEW, w: 80, h: 50 });
  link.stop();
  await quiet();
  assert.equal(frames.length, 1);
  assert.ok(made.every((picture) => picture.closed || picture === frames[0]?.bitmap));
});

test("a picture that is lost is told of once, and the panorama takes the place of the still", async () => {
  const { link, frames, failed } = setup({ lost: ["stops/a/still.jpg"] });
  for (let i = 0; i < 3; i += 1) {
    link.view(VIEW);
    await quiet();
  }
  assert.deepEqual(failed, ["A picture of the tour is not shown: stops/a/still.jpg is not there."]);
  assert.deepEqual(
    frames.map(({ bitmap }) => bitmap.what),
    ["panorama", "panorama", "panorama"],
  );
});

test("the engine is there from the start", async () => {
  const { link } = setup();
  const told: boolean[] = [];
  link.onEngine(({ connected, ready }) => told.push(connected && ready));
  const end = link.onEngine(() => told.push(false));
  assert.deepEqual(told, []);
  end();
  await quiet();
  assert.deepEqual(told, [true]);
});

test("a manifest that is not understood leaves out what it describes", () => {
  const still = { width: 10, height: 6, image: "png", near: 1, far: 9, depth_width: 5, depth_height: 3 };
  const round = { width: 64, height: 32, near: 0, far: 0, depth_width: 32, depth_height: 16 };
  const read = (stop: object, version = 1) => readTourManifest({ version, missing: ["x"], stops: { s: stop } });
  assert.deepEqual(read({ still, panorama: round }).stops.get("s"), {
    still: { width: 10, height: 6, image: "png", nearM: 1, farM: 9, depthWidth: 5, depthHeight: 3 },
    panorama: { width: 64, height: 32, nearM: 0, farM: 0, depthWidth: 0, depthHeight: 0 },
  });
  for (const bad of [
    { still: { ...still, image: "gif" } },
    { still: { ...still, depth_width: 4 } },
    { still: { ...still, far: 0.5 } },
    { still: { ...still, width: 10.5 } },
    { panorama: { ...round, height: 31 } },
  ]) {
    const { stops, missing } = read(bad);
    assert.equal(stops.size, 0);
    assert.match(missing[1] ?? "", /^The pictures of the stop "s" are left out/);
  }
  assert.match(read({}, 2).missing[1] ?? "", /version 2/);
  assert.throws(() => readTourManifest({ version: 1, stops: [] }), /stops: an object expected/);
});
