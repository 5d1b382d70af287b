import assert from "node:assert/strict";
import test from "node:test";
import type { Quat, Vec2, Vec3 } from "../../../src/base/vec.js";
import * as messages from "../../../src/protocol/messages.js";

const VIEW = {
  project: "main" as const,
  eyeEnu: [1, 2, 3] as Vec3,
  rotation: [0, 2, 0, 0] as Quat,
  fovyDeg: 45,
  orthoHeightM: null,
  w: 1000.4,
  h: 563,
};
const RAY = { originEnu: [1, 2, 3] as Vec3, direction: [0, 0, -3] as Vec3, pixelPitch: 0.001, pixelWidthM: 0 };

test("messages have exactly the keys of docs/viewer_protocol.md", () => {
  const cases: readonly (readonly [string, unknown])[] = [
    [messages.helloText(), { type: "hello", version: 1 }],
    [
      messages.viewText(7, VIEW),
      {
        type: "view",
        seq: 7,
        project: "main",
        eye: [1, 2, 3],
        rotation: [0, 1, 0, 0],
        projection: "perspective",
        fovy_deg: 45,
        w: 1000,
        h: 563,
      },
    ],
    [
      messages.viewText(8, { ...VIEW, project: "before", fovyDeg: null, orthoHeightM: 250 }),
      {
        type: "view",
        seq: 8,
        project: "before",
        eye: [1, 2, 3],
        rotation: [0, 1, 0, 0],
        projection: "orthographic",
        height_m: 250,
        w: 1000,
        h: 563,
      },
    ],
    [messages.viewPhotoText(9, 12, 800), { type: "view", seq: 9, photo: 12, w: 800 }],
    [messages.stopText(9), { type: "stop", seq: 9 }],
    [messages.ackText(9, 2), { type: "ack", seq: 9, pass: 2 }],
    [
      messages.pickText(3, RAY, "main"),
      {
        type: "pick",
        id: 3,
        project: "main",
        origin: [1, 2, 3],
        direction: [0, 0, -1],
        pixel_pitch: 0.001,
        pixel_width_m: 0,
      },
    ],
    [messages.photosAtText(4, [1, 2, 3]), { type: "photos_at", id: 4, point: [1, 2, 3] }],
    [
      messages.profileText(5, [1, 2], [3, 4], 100, "before"),
      { type: "profile", id: 5, project: "before", from: [1, 2], to: [3, 4], samples: 100 },
    ],
    [
      messages.volumeText(
        6,
        [
          [0, 0],
          [1.00004, 0],
          [0, 1],
        ],
        "height",
        -2.5,
        "main",
      ),
      {
        type: "volume",
        id: 6,
        project: "main",
        polygon: [
          [0, 0],
          [1, 0],
          [0, 1],
        ],
        base: "height",
        base_height_m: -2.5,
      },
    ],
    [messages.errorMapText(7), { type: "error_map", id: 7 }],
    [messages.trustMapText(9), { type: "trust_map", id: 9 }],
    [messages.cancelText(8), { type: "cancel", id: 8 }],
  ];
  for (const [text, expected] of cases) assert.deepEqual(JSON.parse(text), expected);
});

test("the size of a view is cut to the limits in its shape", () => {
  assert.deepEqual(messages.viewSize(4096, 2304), [2048, 1152]);
  assert.deepEqual(messages.viewSize(100, 3000), [68, 2048]);
  assert.deepEqual(messages.viewSize(4, 300), [16, 300]);
  assert.deepEqual(messages.viewSize(1000, 563), [1000, 563]);
});

test("what the engine would refuse is never sent", () => {
  const wrong: readonly (() => string)[] = [
    () => messages.viewText(1, { ...VIEW, eyeEnu: [Number.NaN, 0, 0] }),
    () => messages.viewText(1, { ...VIEW, eyeEnu: [2e7, 0, 0] }),
    () => messages.viewText(1, { ...VIEW, rotation: [0, 0, 0, 0] }),
    () => messages.viewText(1, { ...VIEW, fovyDeg: 0.5 }),
    () => messages.viewText(1, { ...VIEW, fovyDeg: null }),
    () => messages.viewText(1, { ...VIEW, orthoHeightM: 0 }),
    () => messages.viewText(1, { ...VIEW, w: 0 }),
    () => messages.viewText(1, { ...VIEW, h: Number.POSITIVE_INFINITY }),
    () => messages.viewText(2 ** 32, VIEW),
    () => messages.viewPhotoText(1, -1, 800),
    () => messages.pickText(1, { ...RAY, direction: [0, 0, 0] }, "main"),
    () => messages.pickText(1, { ...RAY, pixelPitch: -1 }, "main"),
    () => messages.pickText(1, { ...RAY, pixelWidthM: 1e5 }, "main"),
    () => messages.photosAtText(1, [0, Number.NEGATIVE_INFINITY, 0]),
    () => messages.profileText(1, [0, 0], [1, 1], 1, "main"),
    () => messages.profileText(1, [0, 0], [1, 1], 1025, "main"),
    () =>
      messages.volumeText(
        1,
        [
          [0, 0],
          [1, 1],
        ],
        "plane",
        0,
        "main",
      ),
    () =>
      messages.volumeText(
        1,
        Array.from({ length: 65 }, (_, i): Vec2 => [i, i * i]),
        "plane",
        0,
        "main",
      ),
    () =>
      messages.volumeText(
        1,
        [
          [0, 0],
          [1, 0],
          [0, 1],
        ],
        "height",
        Number.NaN,
        "main",
      ),
  ];
  for (const [i, make] of wrong.entries()) assert.throws(make, RangeError, `case ${i}`);
});

test("the largest outline fits into a message", () => {
  const corner = (i: number): Vec2 => [-9999999.123456789 + i / 3, -8888888.987654321 - i / 7];
  const text = messages.volumeText(
    0xffffffff,
    Array.from({ length: 64 }, (_, i) => corner(i)),
    "before",
    -1 / 3,
    "before",
  );
  assert.ok(text.length <= 4096, `${text.length} bytes`);
});
