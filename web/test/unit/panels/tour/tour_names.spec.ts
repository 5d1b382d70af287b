import assert from "node:assert/strict";
import test from "node:test";
import { isStart, layersText, stopOptions } from "../../../../src/panels/tour/tour_names.js";
import { setStart } from "../../../../src/tour/edit_stops.js";
import { rowOfStops } from "../../tools/tour_samples.js";

test("words of the tour: where it begins, stops to choose from, layers", () => {
  const tour = rowOfStops();
  const starts = (of: typeof tour) => of.stops.map((stop) => isStart(of, stop));
  assert.deepEqual(starts(tour), [true, false, false]);
  assert.deepEqual(starts(setStart(tour, "stop-3")), [false, false, true]);
  assert.deepEqual(stopOptions(tour, "stop-2"), [
    ["stop-1", "1. Stop 1"],
    ["stop-3", "3. Stop 3"],
  ]);
  assert.equal(layersText({ surface: true, points: false }), "Shows surface; hides sparse points.");
});
