import assert from "node:assert/strict";
import test from "node:test";
import { CheckError } from "../../../src/base/check.js";
import { inflateDepth, parseFrame } from "../../../src/protocol/frame.js";
import { type FrameFields, frameBytes, inflate } from "./fakes.js";

test("a header is read field by field", () => {
  const { header, color } = parseFrame(frameBytes({ seq: 0xfffffffe, revision: 7, pass: 2, flags: 1 }));
  assert.deepEqual(header, {
    seq: 0xfffffffe,
    revision: 7,
    pass: 2,
    passes: 3,
    format: "png",
    project: "before",
    isPhoto: false,
    width: 5,
    height: 3,
    eyeEnu: [1.5, -2.5, 1e5],
    rotation: [0, 1, 0, 0],
    fovyDeg: 60,
    orthoHeightM: null,
    nearM: 2,
    farM: 10,
    depthWidth: 3,
    depthHeight: 2,
  });
  assert.deepEqual([...color], [1, 2, 3]);
  const photo = parseFrame(frameBytes({ flags: 4, format: 0 })).header;
  assert.ok(photo.isPhoto && photo.format === "jpeg" && photo.project === "main");
  const top = parseFrame(frameBytes({ flags: 2, size: 250, near: -5, far: 60 })).header;
  assert.ok(top.fovyDeg === null && top.orthoHeightM === 250);
});

function refused(bytes: ArrayBuffer, what: RegExp): void {
  assert.throws(
    () => parseFrame(bytes),
    (error: unknown) => error instanceof CheckError && what.test(error.message),
  );
}

test("what is not a frame is refused with its reason", () => {
  const cases: readonly (readonly [FrameFields, RegExp])[] = [
    [{ pass: 3 }, /pass/],
    [{ format: 2 }, /format/],
    [{ flags: 8 }, /flags/],
    [{ width: 0 }, /size/],
    [{ width: 5000, depth: [] }, /size/],
    [{ rotation: [0, 0, 0, 0] }, /rotation/],
    [{ rotation: [Number.NaN, 0, 0, 1] }, /rotation/],
    [{ size: 0 }, /field of view/],
    [{ size: 180 }, /field of view/],
    [{ near: 0 }, /near/],
    [{ near: 11 }, /near/],
    [{ far: Number.POSITIVE_INFINITY }, /far/],
    [{ color: [] }, /colour/],
  ];
  for (const [fields, what] of cases) refused(frameBytes(fields), what);
});

test("every wrong length is refused before the bytes are used", () => {
  const whole = frameBytes();
  for (let length = 0; length < whole.byteLength; length += 1) refused(whole.slice(0, length), /length/);
  const longer = new Uint8Array(whole.byteLength + 1);
  longer.set(new Uint8Array(whole));
  refused(longer.buffer, /length/);
  const announced = frameBytes();
  new DataView(announced).setUint32(108, 0xffffffff, true);
  refused(announced, /length/);
  const part = frameBytes();
  new DataView(part).setUint16(28, 4, true);
  refused(part, /rectangle/);
  const depthSize = frameBytes();
  new DataView(depthSize).setUint16(104, 2, true);
  refused(depthSize, /depth/);
});

test("whatever the bytes, only a CheckError", () => {
  for (let i = 0; i < 128; i += 1) {
    for (const value of [0, 1, 0x7f, 0xff]) {
      const bytes = frameBytes();
      new Uint8Array(bytes)[i] = value;
      try {
        parseFrame(bytes);
      } catch (error) {
        assert.ok(error instanceof CheckError, `byte ${i} = ${value}: ${error}`);
      }
    }
  }
});

test("perspective depth is inverse between near and far, 0 is no surface", async () => {
  const depth = await inflateDepth(parseFrame(frameBytes()), inflate);
  const half = 1 / (1 / 10 + (32767 / 65534) * (1 / 2 - 1 / 10));
  const expected = [Number.NaN, 10, 2, half];
  expected.forEach((value, i) => {
    const found = depth[i] ?? 0;
    assert.ok(Number.isNaN(value) ? Number.isNaN(found) : Math.abs(found - value) < 1e-6, `${i}: ${found}`);
  });
  assert.equal(depth.length, 6);
});

test("orthographic depth is linear and may be negative", async () => {
  const depth = await inflateDepth(parseFrame(frameBytes({ flags: 2, near: -5, far: 65529 })), inflate);
  assert.deepEqual([...depth].slice(1), [-5, 65529, 32762, -4, -3]);
});

test("a frame without depth has none; depth of the wrong length is refused", async () => {
  assert.equal((await inflateDepth(parseFrame(frameBytes({ depth: [] })), inflate)).length, 0);
  await assert.rejects(inflateDepth(parseFrame(frameBytes({ depth: [1, 2, 3] })), inflate), /6 bytes instead of 12/);
});
