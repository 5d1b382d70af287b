import assert from "node:assert/strict";
import test from "node:test";
import {
  centreOn,
  fitPicture,
  LARGEST_SCALE,
  panBy,
  toPicture,
  toView,
  zoomTo,
} from "../../../../src/panels/photos/picture_zoom.js";

const view = { w: 800, h: 600 };
const picture = { w: 4000, h: 2000 };

test("the whole picture fits and is centred", () => {
  assert.deepEqual(fitPicture(view, picture), { scale: 0.2, x: 0, y: 100 });
});

test("a window of no size gives finite numbers", () => {
  const zoom = fitPicture({ w: 0, h: 0 }, picture);
  assert.ok([zoom.scale, zoom.x, zoom.y].every(Number.isFinite));
  assert.ok(zoom.scale > 0);
});

test("places go to the view and back", () => {
  const zoom = { scale: 2.5, x: -100.5, y: 17 };
  assert.deepEqual(toPicture(zoom, toView(zoom, [12.25, 99.75])), [12.25, 99.75]);
});

test("zooming keeps what is under the pointer", () => {
  const at = [400, 300] as const;
  const before = fitPicture(view, picture);
  const after = zoomTo(before, 1, at, view, picture);
  const [x, y] = toPicture(before, at);
  const [x2, y2] = toPicture(after, at);
  assert.ok(Math.hypot(x - x2, y - y2) < 1e-9);
  assert.equal(after.scale, 1);
});

test("the scale stays between the whole picture and 8 times", () => {
  const fit = fitPicture(view, picture);
  assert.equal(zoomTo(fit, 100, [0, 0], view, picture).scale, LARGEST_SCALE);
  assert.deepEqual(zoomTo(zoomTo(fit, 3, [10, 500], view, picture), 0.001, [700, 20], view, picture), fit);
  assert.equal(zoomTo(fit, Number.NaN, [0, 0], view, picture), fit);
});

test("panning stops at the picture's edges, and a side that fits stays centred", () => {
  const zoom = zoomTo(fitPicture(view, picture), 1, [400, 300], view, picture);
  assert.equal(panBy(zoom, [1e6, 0], view, picture).x, 0);
  assert.equal(panBy(zoom, [-1e6, 0], view, picture).x, 800 - 4000);
  const wide = zoomTo(fitPicture(view, picture), 0.25, [400, 300], view, picture);
  assert.equal(panBy(wide, [0, 55], view, picture).y, 50);
});

test("a pixel comes to the middle, except at the edge", () => {
  assert.deepEqual(toView(centreOn([2000, 1000], 4, view, picture), [2000, 1000]), [400, 300]);
  assert.deepEqual(toView(centreOn([0, 0], 4, view, picture), [0, 0]), [0, 0]);
});
