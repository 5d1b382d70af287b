import assert from "node:assert/strict";
import test from "node:test";
import { listPhotos, stepPhoto } from "../../../src/panels/photos/photo_list.js";
import { groupCommands } from "../../../src/panels/shell/command_groups.js";
import { splitAdvice } from "../../../src/panels/widgets/advice.js";
import { readNumber } from "../../../src/panels/widgets/read_number.js";
import type { PhotoSight } from "../../../src/state/app_state.js";
import { markEntries, residualPx, withMark } from "../../../src/state/control_points.js";
import type { Photo } from "../../../src/state/project.js";

const photos: readonly Photo[] = ["A1.jpg", "a2.jpg", "b3.jpg"].map((name, index) => ({
  index,
  name,
  camera: 0,
  position: [0, 0, 0],
  rotation: [1, 0, 0, 0],
  isTest: false,
  psnrDb: null,
  available: true,
}));
const sight = (photo: number, gsdM: number, visible: boolean): PhotoSight => ({
  photo,
  gsdM,
  visible,
  pixel: [10, 20],
  distanceM: 1,
});
const names = (entries: readonly { readonly photo: Photo }[]): string[] => entries.map((entry) => entry.photo.name);

test("without a point all photos are listed in their order; search takes either case", () => {
  assert.deepEqual(names(listPhotos(photos, null, "")), ["A1.jpg", "a2.jpg", "b3.jpg"]);
  assert.deepEqual(names(listPhotos(photos, null, " a")), ["A1.jpg", "a2.jpg"]);
});

test("hidden photos come last, finest first, and unknown indices are left out", () => {
  const sights = [sight(0, 0.01, false), sight(1, 0.05, true), sight(2, 0.02, true), sight(9, 0.001, true)];
  assert.deepEqual(names(listPhotos(photos, sights, "")), ["b3.jpg", "a2.jpg", "A1.jpg"]);
});

test("stepping goes round the list and copes with an empty one", () => {
  const entries = listPhotos(photos, null, "");
  assert.equal(stepPhoto(entries, 2, 1), 0);
  assert.equal(stepPhoto(entries, 0, -1), 2);
  assert.equal(stepPhoto(listPhotos(photos, null, "a"), 2, 1), 0);
  assert.equal(stepPhoto([], 0, 1), null);
});

test("marked photos come first, also those that should not see the point", () => {
  const point = {
    name: "P",
    xyz: [0, 0, 0] as const,
    marks: [
      { photo: "b3.jpg", pixel: [13, 24] as const },
      { photo: "gone.jpg", pixel: [0, 0] as const },
    ],
  };
  const entries = markEntries(point, photos, [sight(0, 0.03, true), sight(1, 0.01, false)]);
  assert.deepEqual(names(entries), ["b3.jpg", "A1.jpg", "a2.jpg"]);
  assert.deepEqual(
    entries.map((entry) => residualPx(entry)),
    [null, null, null],
  );
  const seen = markEntries(point, photos, [sight(2, 0.03, true)])[0];
  assert.ok(seen);
  assert.equal(residualPx(seen), 5);
});

test("a photo has one mark of a point", () => {
  const point = { name: "P", xyz: [0, 0, 0] as const, marks: [{ photo: "a", pixel: [1, 1] as const }] };
  assert.deepEqual(withMark(point, "a", [2, 2]).marks, [{ photo: "a", pixel: [2, 2] }]);
  assert.equal(withMark(point, "b", [2, 2]).marks.length, 2);
  assert.deepEqual(withMark(point, "a", null).marks, []);
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

test("commands are grouped by their ids and none is lost", () => {
  const command = (id: string) => ({ id, label: id, keys: [], when: () => true, run: () => {} });
  const groups = groupCommands(["tool.point", "view.all", "navigation.fly", "odd"].map(command));
  assert.deepEqual(
    groups.map(({ title, commands }) => [title, commands.map(({ id }) => id)]),
    [
      ["View", ["view.all", "navigation.fly"]],
      ["Tools", ["tool.point"]],
      ["More", ["odd"]],
    ],
  );
});

test("typed numbers", () => {
  assert.equal(readNumber(" 12,5 "), 12.5);
  assert.equal(readNumber("-0.25"), -0.25);
  for (const text of ["", "12abc", "1.2.3", "1,2,3", "1e5", "Infinity", "0x10"])
    assert.equal(readNumber(text), null, text);
});
