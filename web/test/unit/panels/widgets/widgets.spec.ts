import assert from "node:assert/strict";
import test from "node:test";
import { splitAdvice } from "../../../../src/panels/widgets/advice.js";
import { psnrQuality, rampColour } from "../../../../src/panels/widgets/ramp.js";
import { readNumber } from "../../../../src/panels/widgets/read_number.js";
import { stepOfKey } from "../../../../src/panels/widgets/slider_keys.js";

test("the ramp begins and ends like viridis and is clamped", () => {
  assert.equal(rampColour(0), "rgb(68 1 84)");
  assert.equal(rampColour(7), "rgb(253 231 37)");
  assert.equal(rampColour(Number.NaN), rampColour(0));
  assert.equal(rampColour(1 / 16), "rgb(70 21 102)");
  assert.equal(psnrQuality(27.5), 0.5);
});

test("keys of a slider", () => {
  assert.equal(stepOfKey("ArrowRight", false, 0.5), 0.51);
  assert.equal(stepOfKey("ArrowLeft", true, 0.05), 0);
  assert.equal(stepOfKey("End", false, 0.2), 1);
  assert.equal(stepOfKey("Tab", false, 0.2), null);
});

test("commands in advice are set apart", () => {
  assert.deepEqual(splitAdvice("Make it: skyquilt surface /data/my town"), [
    { text: "Make it:", command: false },
    { text: "skyquilt surface /data/my town", command: true },
  ]);
  assert.deepEqual(splitAdvice("Run `skyquilt merge /x` first, then reload."), [
    { text: "Run", command: false },
    { text: "skyquilt merge /x", command: true },
    { text: "first, then reload.", command: false },
  ]);
  assert.deepEqual(splitAdvice("See the manual of skyquilt."), [
    { text: "See the manual of skyquilt.", command: false },
  ]);
  assert.deepEqual(splitAdvice(""), []);
});

test("typed numbers", () => {
  assert.equal(readNumber(" 12,5 "), 12.5);
  assert.equal(readNumber("-0.25"), -0.25);
  for (const text of ["", "12abc", "1.2.3", "1,2,3", "1e5", "Infinity", "0x10"])
    assert.equal(readNumber(text), null, text);
});
