import assert from "node:assert/strict";
import test from "node:test";
import { CheckError } from "../../../src/base/check.js";
import { MOST_FILE_BYTES } from "../../../src/tour/limits.js";
import { readTour } from "../../../src/tour/read.js";
import { usableLine, usableText, utf8Bytes } from "../../../src/tour/text_rules.js";
import { EMPTY_TOUR, followingStop } from "../../../src/tour/types.js";
import { writeTour } from "../../../src/tour/write.js";
import { MODEL, PICTURE, sampleFile, sampleTour } from "./samples.js";

type File = ReturnType<typeof sampleFile>;

/** The path of the error that the damaged file gives. */
function pathOf(damage: (file: File) => void): string {
  const file = sampleFile();
  damage(file);
  try {
    readTour(JSON.parse(JSON.stringify(file)));
  } catch (error) {
    assert.ok(error instanceof CheckError, String(error));
    return error.path;
  }
  return "no error";
}

/** A member of something whose type the sample fixes. */
function put(target: unknown, key: string, value: unknown): void {
  (target as Record<string, unknown>)[key] = value;
}

test("what is written is read again, and written as the same bytes", () => {
  const tour = sampleTour();
  const text = writeTour(tour);
  const again = readTour(JSON.parse(text));
  assert.deepEqual(again, tour);
  assert.equal(writeTour(again), text);
  // Another order of members and assets in memory makes no other file.
  const turned = {
    ...tour,
    assets: new Map([...tour.assets].reverse()),
    stops: tour.stops.map((stop) => ({ ...stop })),
  };
  assert.equal(writeTour(turned), text);
  assert.deepEqual(JSON.parse(text), JSON.parse(JSON.stringify(sampleFile())));
  assert.deepEqual(readTour(JSON.parse(writeTour(EMPTY_TOUR))), EMPTY_TOUR);
});

test("what may be null may be left out", () => {
  const { eye_enu, rotation, fovy_deg } = sampleFile().stops[0]?.pose ?? { eye_enu: [], rotation: [], fovy_deg: 0 };
  const tour = readTour({ version: 1, stops: [{ id: "x", title: "X", pose: { eye_enu, rotation, fovy_deg } }] });
  assert.deepEqual(
    [tour.title, tour.start, tour.things, tour.assets.size, tour.stops[0]?.next, tour.stops[0]?.branches],
    ["", null, [], 0, null, []],
  );
});

test("every field is checked, and the error has its path", () => {
  const cases: [string, (file: File) => void][] = [
    ["version", (file) => put(file, "version", 2)],
    ["title", (file) => put(file, "title", "x".repeat(201))],
    ["title", (file) => put(file, "title", "two\nlines")],
    ["start", (file) => put(file, "start", "nowhere")],
    ["start", (file) => put(file, "start", 5)],
    ["stops", (file) => put(file, "stops", {})],
    ["stops", (file) => put(file, "stops", Array(201).fill(file.stops[0]))],
    ["stops[0]", (file) => put(file.stops[0], "sound", "x")],
    ["", (file) => put(file, "sound", "x")],
    ["stops[1].id", (file) => put(file.stops[1], "id", "a")],
    ["things[0].id", (file) => put(file.things[0], "id", "a")],
    ["stops[0].id", (file) => put(file.stops[0], "id", "a b")],
    ["stops[0].id", (file) => put(file.stops[0], "id", "")],
    ["stops[0].title", (file) => put(file.stops[0], "title", "")],
    ["stops[0].text", (file) => put(file.stops[0], "text", "bell \u0007")],
    ["stops[0].text", (file) => put(file.stops[0], "text", "x".repeat(10001))],
    ["stops[0].picture", (file) => put(file.stops[0], "picture", "../../etc/passwd")],
    ["stops[0].picture", (file) => put(file.stops[0], "picture", MODEL)],
    ["stops[0].picture", (file) => put(file, "assets", { [MODEL]: file.assets[MODEL] })],
    ["things[2].asset", (file) => put(file, "assets", { [PICTURE]: file.assets[PICTURE] })],
    ["stops[0].link.url", (file) => put(file.stops[0]?.link, "url", "javascript:alert(1)")],
    ["stops[0].link.url", (file) => put(file.stops[0]?.link, "url", " https://example.org")],
    ["stops[0].link.url", (file) => put(file.stops[0]?.link, "url", "https://")],
    ["stops[0].pose.rotation", (file) => put(file.stops[0]?.pose, "rotation", [1.00001, 0, 0, 0])],
    ["stops[0].pose.rotation", (file) => put(file.stops[0]?.pose, "rotation", [1, 0, 0])],
    ["stops[0].pose.eye_enu[2]", (file) => put(file.stops[0]?.pose, "eye_enu", [0, 0, 2e9])],
    ["stops[0].pose.fovy_deg", (file) => put(file.stops[0]?.pose, "fovy_deg", 121)],
    ["stops[0].exposure_stops", (file) => put(file.stops[0], "exposure_stops", 11)],
    ["stops[0].layers", (file) => put(file.stops[0]?.layers, "moon", true)],
    ["stops[0].layers.points", (file) => put(file.stops[0]?.layers, "points", 1)],
    ["stops[0].measurements", (file) => put(file.stops[0], "measurements", Array(101).fill("m"))],
    ["stops[0].pause_s", (file) => put(file.stops[0], "pause_s", -1)],
    ["stops[1].next.to", (file) => put(file.stops[1]?.next, "to", "nowhere")],
    ["stops[1].next.path.kind", (file) => put(file.stops[1]?.next, "path", { kind: "teleport" })],
    ["stops[1].next.path", (file) => put(file.stops[1]?.next, "path", { kind: "over", about: [0, 0, 0] })],
    ["stops[0].branches[0].to", (file) => put(file.stops[0]?.branches[0], "to", "nowhere")],
    ["stops[0].branches[0].path.about", (file) => put(file.stops[0]?.branches[0], "path", { kind: "orbit" })],
    ["stops[0].branches", (file) => put(file.stops[0], "branches", Array(21).fill(file.stops[0]?.branches[0]))],
    ["things[0].kind", (file) => put(file.things[0], "kind", "sound")],
    ["things[0]", (file) => put(file.things[0], "scale", 1)],
    ["things[1].to", (file) => put(file.things[1], "to", "nowhere")],
    ["things[1].stops[1]", (file) => put(file.things[1], "stops", ["a", "nowhere"])],
    ["things[2].scale", (file) => put(file.things[2], "scale", 0)],
    ["things[2].yaw_deg", (file) => put(file.things[2], "yaw_deg", 361)],
    [`assets.${MODEL.slice(0, 59)}….bytes`, (file) => put(file.assets[MODEL], "bytes", 0)],
    ["assets.__proto__", (file) => put(file, "assets", JSON.parse('{"__proto__": {"name": "x", "bytes": 1}}'))],
  ];
  for (const [path, damage] of cases) assert.equal(pathOf(damage), path, String(damage));
});

test("lengths count characters, not halves of them", () => {
  const title = "𝔸".repeat(200);
  const file = sampleFile();
  file.title = title;
  assert.equal(readTour(file).title, title);
  assert.equal(
    pathOf((damaged) => put(damaged, "title", `${title}𝔸`)),
    "title",
  );
  // Half a pair cannot be written as UTF-8.
  const half = sampleFile();
  half.title = "\ud835";
  assert.throws(() => readTour(half), CheckError);
});

test("nothing is written that could not be read or is too long for the server", () => {
  const tour = sampleTour();
  assert.throws(() => writeTour({ ...tour, title: "two\nlines" }), /^CheckError: title/);
  assert.throws(() => writeTour({ ...tour, start: "nowhere" }), /^CheckError: start/);
  const [stop] = tour.stops;
  assert.ok(stop);
  const stops = Array.from({ length: 60 }, (_, i) => ({ ...stop, id: `s${i}`, branches: [], text: "村".repeat(6000) }));
  assert.throws(() => writeTour({ ...tour, start: null, stops, things: [] }), /1 MiB/);
  const fewer = { ...tour, start: null, stops: stops.slice(0, 50), things: [] };
  const bytes = new TextEncoder().encode(writeTour(fewer)).length;
  assert.ok(bytes < MOST_FILE_BYTES && bytes > 0.8 * MOST_FILE_BYTES);
});

test("what people type becomes a line or a text that may be saved", () => {
  assert.equal(usableLine("  two\nlines\u0000 \ud835 "), "two lines");
  assert.equal(usableLine(" \n\t "), null);
  assert.equal(usableLine("𝔸".repeat(300)), "𝔸".repeat(200));
  assert.equal(usableText("a\r\nb\tc\u0007"), "a\nb\tc ");
  assert.equal([...usableText("村".repeat(20000))].length, 10000);
  for (const text of ["", "abc", "äß", "村деревня", "𝔸🏠"]) {
    assert.equal(utf8Bytes(text), new TextEncoder().encode(text).length);
  }
});

test("the next stop is the named one, else that of the list, else none", () => {
  const tour = sampleTour();
  const [a, b, c] = tour.stops;
  assert.ok(a && b && c);
  assert.equal(followingStop(tour, a), b);
  assert.equal(followingStop(tour, b), c);
  assert.equal(followingStop(tour, c), null);
  assert.equal(followingStop(tour, { ...c, next: { to: null, path: { kind: "over" } } }), null);
});
