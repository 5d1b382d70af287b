import assert from "node:assert/strict";
import test from "node:test";
import { listPhotos, stepPhoto } from "../../../../src/panels/photos/photo_list.js";
import { namesOf, SAMPLE_PHOTOS, sampleSight } from "../../state/photo_samples.js";

test("without a point all photos are listed in their order; search takes either case", () => {
  assert.deepEqual(namesOf(listPhotos(SAMPLE_PHOTOS, null, "")), ["A1.jpg", "a2.jpg", "b3.jpg"]);
  assert.deepEqual(namesOf(listPhotos(SAMPLE_PHOTOS, null, " a")), ["A1.jpg", "a2.jpg"]);
});

test("hidden photos come last, finest first, and unknown indices are left out", () => {
  const sights = [
    sampleSight(0, 0.01, false),
    sampleSight(1, 0.05, true),
    sampleSight(2, 0.02, true),
    sampleSight(9, 0.001, true),
  ];
  assert.deepEqual(namesOf(listPhotos(SAMPLE_PHOTOS, sights, "")), ["b3.jpg", "a2.jpg", "A1.jpg"]);
});

test("stepping goes round the list and copes with an empty one", () => {
  const entries = listPhotos(SAMPLE_PHOTOS, null, "");
  assert.equal(stepPhoto(entries, 2, 1), 0);
  assert.equal(stepPhoto(entries, 0, -1), 2);
  assert.equal(stepPhoto(listPhotos(SAMPLE_PHOTOS, null, "a"), 2, 1), 0);
  assert.equal(stepPhoto([], 0, 1), null);
});
