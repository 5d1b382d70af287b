import assert from "node:assert/strict";
import test from "node:test";
import { markEntries, mergeControlPoints, residualPx, withMark } from "../../../src/state/control_points.js";
import { namesOf, SAMPLE_PHOTOS, sampleSight } from "./photo_samples.js";

test("marked photos come first, also those that should not see the point", () => {
  const point = {
    name: "P",
    xyz: [0, 0, 0] as const,
    marks: [
      { photo: "b3.jpg", pixel: [13, 24] as const },
      { photo: "gone.jpg", pixel: [0, 0] as const },
    ],
  };
  const entries = markEntries(point, SAMPLE_PHOTOS, [sampleSight(0, 0.03, true), sampleSight(1, 0.01, false)]);
  assert.deepEqual(namesOf(entries), ["b3.jpg", "A1.jpg", "a2.jpg"]);
  assert.deepEqual(
    entries.map((entry) => residualPx(entry)),
    [null, null, null],
  );
  const seen = markEntries(point, SAMPLE_PHOTOS, [sampleSight(2, 0.03, true)])[0];
  assert.ok(seen);
  assert.equal(residualPx(seen), 5);
});

test("a photo has one mark of a point", () => {
  const point = { name: "P", xyz: [0, 0, 0] as const, marks: [{ photo: "a", pixel: [1, 1] as const }] };
  assert.deepEqual(withMark(point, "a", [2, 2]).marks, [{ photo: "a", pixel: [2, 2] }]);
  assert.equal(withMark(point, "b", [2, 2]).marks.length, 2);
  assert.deepEqual(withMark(point, "a", null).marks, []);
});

test("loading again replaces marks in the same photos and keeps the others", () => {
  const mark = (photo: string, x: number) => ({ photo, pixel: [x, 0] as const });
  const merged = mergeControlPoints(
    [
      { name: "P", xyz: [0, 0, 0], marks: [mark("a", 1), mark("b", 1)] },
      { name: "Q", xyz: [1, 1, 1], marks: [] },
    ],
    [
      { name: "P", xyz: [5, 5, 5], marks: [mark("b", 2)] },
      { name: "R", xyz: [2, 2, 2], marks: [] },
    ],
  );
  assert.deepEqual(merged, [
    { name: "P", xyz: [5, 5, 5], marks: [mark("a", 1), mark("b", 2)] },
    { name: "Q", xyz: [1, 1, 1], marks: [] },
    { name: "R", xyz: [2, 2, 2], marks: [] },
  ]);
});
