import assert from "node:assert/strict";
import test from "node:test";
import { boxAround, withFace } from "../../../src/state/clip_box.js";

test("faces of the clip box do not pass each other", () => {
  const box = { on: true, min: [0, 0, 0], max: [10, 10, 10] } as const;
  assert.deepEqual(withFace(box, "min", 0, 4).min, [4, 0, 0]);
  assert.deepEqual(withFace(box, "min", 1, 50).min, [0, 9.9, 0]);
  assert.deepEqual(withFace(box, "max", 2, -50).max, [10, 10, 0.1]);
  assert.equal(withFace(box, "max", 2, Number.NaN), box);
});

test("a box around points leaves out what is not finite", () => {
  assert.equal(boxAround([[Number.NaN, 0, 0]], 1), null);
  assert.deepEqual(
    boxAround(
      [
        [0, 5, 2],
        [3, -1, 2],
        [Number.NaN, 0, 0],
      ],
      1,
    ),
    { min: [-1, -2, 1], max: [4, 6, 3] },
  );
});
