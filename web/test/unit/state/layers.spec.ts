import assert from "node:assert/strict";
import test from "node:test";
import type { DrapedMap, ErrorMap } from "../../../src/state/app_state.js";
import { initialState } from "../../../src/state/initial.js";
import { isMapLayer, shownMap, withLayer } from "../../../src/state/layers.js";
import { sampleProject } from "./samples.js";

const TRUST: DrapedMap = { url: "/data/pictures/2.png", min: [0, 0], max: [1, 1], scale: 0.25 };
const HELD_OUT: ErrorMap = { ...TRUST, url: "/data/pictures/1.png", photos: 2, ofPhotos: 3 };

test("a map that goes on takes the place of the other, and all else stays", () => {
  const { layers } = initialState(sampleProject());
  const heldOut = withLayer(layers, "errorMap", true);
  assert.deepEqual(heldOut, { ...layers, errorMap: true });
  const trust = withLayer(heldOut, "trust", true);
  assert.deepEqual(trust, { ...layers, trust: true });
  assert.deepEqual(withLayer(trust, "errorMap", false), trust);
  assert.deepEqual(withLayer(trust, "contours", true), { ...trust, contours: true });
  assert.deepEqual(withLayer(trust, "trust", false), layers);
  assert.ok(isMapLayer("trust") && !isMapLayer("surface"));
});

test("the map that is on is shown once it is there", () => {
  const { layers } = initialState(sampleProject());
  const maps = { errorMap: HELD_OUT, trust: TRUST };
  assert.equal(shownMap({ layers, ...maps }), null);
  assert.equal(shownMap({ layers: withLayer(layers, "errorMap", true), ...maps }), HELD_OUT);
  const trust = withLayer(layers, "trust", true);
  assert.equal(shownMap({ layers: trust, ...maps }), TRUST);
  assert.equal(shownMap({ layers: trust, ...maps, trust: null }), null);
});
