import assert from "node:assert/strict";
import test from "node:test";
import { CheckError } from "../../../src/base/check.js";
import { readTourForPlaying } from "../../../src/tour/read_for_playing.js";
import { MODEL, PICTURE, sampleFile, sampleTour } from "./samples.js";

test("a whole tour plays as it is, with nothing to say", () => {
  assert.deepEqual(readTourForPlaying(sampleFile()), { tour: sampleTour(), missing: [] });
});

test("what is not there is left out and named", () => {
  const file = sampleFile();
  file.start = "gone";
  file.things.push(
    { id: "s", kind: "sound", at: [0, 0, 0], text: "Bells", stops: null },
    { id: "n", kind: "label", at: [0, 0, 0], text: "Only there", stops: ["gone"] },
    { id: "p", kind: "marker", at: [0, 0, 0], text: "Gap", to: "gone", stops: ["gone", "a"] },
  );
  const [a, b] = file.stops;
  assert.ok(a && b);
  b.next = { to: "gone", path: { kind: "jump" } };
  b.branches = [{ to: "gone", label: "To the mill", path: { kind: "direct" } }];
  a.next = { to: "b", path: { kind: "spiral", turns: 3 } };
  a.layers = { surface: true, fog: true };
  Object.assign(a, { sound: "bells.mp3" });
  const { tour, missing } = readTourForPlaying(file);
  assert.equal(tour.start, null);
  assert.deepEqual(
    tour.things.map(({ id }) => id),
    ["l", "m", "h", "p"],
  );
  const gap = tour.things[3];
  assert.ok(gap?.kind === "marker" && gap.to === null && gap.stops?.join() === "a");
  assert.deepEqual(tour.stops[1]?.next, { to: null, path: { kind: "direct" } });
  assert.deepEqual(tour.stops[1]?.branches, []);
  assert.deepEqual(tour.stops[0]?.next, { to: "b", path: { kind: "direct" } });
  assert.deepEqual(tour.stops[0]?.layers, { surface: true });
  const words = [
    "gone",
    "Bells",
    "Only there",
    "Gap",
    "The square",
    "To the mill",
    "The gate",
    "fog",
    "stops[0].sound",
  ];
  for (const word of words)
    assert.ok(
      missing.some((sentence) => sentence.includes(word)),
      word,
    );
  assert.equal(missing.length, 9);
  for (const sentence of missing) assert.match(sentence, /^["A-Z].*\.$/);
});

test("pictures and models without their file are left out by the name they were uploaded with", () => {
  const { tour, missing } = readTourForPlaying(sampleFile(), (asset) => asset !== MODEL);
  assert.deepEqual(missing, ['The model "New house" is left out: its file "house.glb" is missing.']);
  assert.deepEqual([tour.things.length, tour.stops[0]?.picture], [2, PICTURE]);
  const file = sampleFile();
  file.assets = {};
  const none = readTourForPlaying(file);
  assert.equal(none.missing.length, 2);
  assert.deepEqual([none.tour.things.length, none.tour.stops[0]?.picture], [2, null]);
});

test("another version plays what is understood", () => {
  const file = sampleFile();
  file.version = 3;
  Object.assign(file, { music: true });
  Object.assign(file.stops[1] ?? {}, { pose: { panorama: 7 } });
  Object.assign(file.things[0] ?? {}, { at: "everywhere" });
  const { tour, missing } = readTourForPlaying(file);
  assert.deepEqual(
    tour.stops.map(({ id }) => id),
    ["a", "c"],
  );
  assert.ok(missing[0]?.includes("version 3"));
  for (const word of ["music", "The square", "Oak", "pose"]) {
    assert.ok(
      missing.some((sentence) => sentence.includes(word)),
      word,
    );
  }
});

test("a damaged file of the known version is an error with the field's path", () => {
  const file = sampleFile();
  Object.assign(file.stops[1] ?? {}, { pause_s: "long" });
  assert.throws(
    () => readTourForPlaying(file),
    (error: unknown) => error instanceof CheckError && error.path === "stops[1].pause_s",
  );
  for (const wrong of [null, [], "tour", {}, { version: 0 }, { version: 1 }, { version: 2, stops: 5 }]) {
    assert.throws(() => readTourForPlaying(wrong), CheckError);
  }
});

test("a file of nonsense does not make a list without end", () => {
  const file = sampleFile();
  for (let i = 0; i < 500; i += 1) Object.assign(file, { [`x${i}`.repeat(50)]: 1 });
  const { missing } = readTourForPlaying(file);
  assert.equal(missing.length, 100);
  assert.match(missing[99] ?? "", /401 more/);
  assert.ok(missing.every((sentence) => sentence.length < 200));
});
