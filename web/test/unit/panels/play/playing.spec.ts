import assert from "node:assert/strict";
import test from "node:test";
import { swipeOf } from "../../../../src/panels/play/swipe_gesture.js";
import { mapBox, onMap, pictureTransform, tourBox, withinMap } from "../../../../src/panels/play/tour_map_view.js";

test("the map holds all places with a margin, north up, and is never too small", () => {
  const box = mapBox([
    [0, 0, 5],
    [700, 100, 5],
  ]);
  assert.ok(box !== null);
  assert.ok(Math.abs(box.sideM - 1000) < 1e-9);
  const [west, east] = [onMap(box, [0, 0, 0]), onMap(box, [700, 100, 0])];
  assert.ok(west[0] > 0.14 && east[0] < 0.86);
  assert.ok(east[1] < west[1], "north is up");
  assert.equal(mapBox([[3, 4, 5]])?.sideM, 40);
  assert.deepEqual(onMap(mapBox([[3, 4, 5]]) ?? assert.fail(), [3, 4, 0]), [0.5, 0.5]);
  assert.equal(mapBox([]), null);
  assert.deepEqual(withinMap([-5, 0.5]), [0.03, 0.5]);
});

test("the map shows all of the ground, but not when the stops would be a spot in it", () => {
  const ground = { url: "x", corner: [-100, 50], across: [200, 0], down: [0, -100] } as const;
  const wide =
    tourBox(
      [
        [0, 60, 9],
        [40, 0, 9],
      ],
      ground,
    ) ?? assert.fail();
  assert.ok(wide.left < -100 && wide.left + wide.sideM > 100);
  assert.ok(wide.top < -60);
  const near = [
    [0, 0, 9],
    [20, 0, 9],
  ] as const;
  assert.deepEqual(tourBox(near, ground), mapBox(near));
  assert.equal(tourBox([], ground), null);
});

test("the picture of the ground lies where its corners are", () => {
  const transform = pictureTransform({ url: "x", corner: [-10, 20], across: [40, 1], down: [1, -30] });
  const [a = 0, b = 0, c = 0, d = 0, e = 0, f = 0] = (/\((.*)\)/.exec(transform)?.[1] ?? "").split(" ").map(Number);
  const at = (u: number, v: number) => [a * u + c * v + e, b * u + d * v + f];
  // SVG's y grows to the south.
  assert.deepEqual(at(0, 0), [-10, -20]);
  assert.deepEqual(at(1, 0), [30, -21]);
  assert.deepEqual(at(0, 1), [-9, 10]);
});

test("a quick finger to the side is a swipe, a slow, short or steep one is not", () => {
  assert.equal(swipeOf([200, 100], [100, 110], 200), "left");
  assert.equal(swipeOf([100, 100], [200, 90], 200), "right");
  assert.equal(swipeOf([100, 100], [130, 100], 200), null);
  assert.equal(swipeOf([100, 100], [200, 180], 200), null);
  assert.equal(swipeOf([100, 100], [200, 100], 2000), null);
});
