import assert from "node:assert/strict";
import test from "node:test";
import { buildingsOf, bytesOf, type Files, readExportedTour } from "../../../src/entry/exported_tour.js";
import type { Bytes } from "../../../src/protocol/packed_files.js";

const PICTURE = `${"a".repeat(64)}.png`;
const POSE = { eye_enu: [1, 2, 3], rotation: [1, 0, 0, 0], fovy_deg: 50 };
const STILL = { width: 10, height: 6, image: "png", near: 1, far: 9, depth_width: 5, depth_height: 3 };
const PROJECT = {
  name: "sample",
  revision: 1,
  georeferenced: false,
  origin: { latitude_deg: 0, longitude_deg: 0, height_m: 0 },
  vertical: "",
  min_enu: [0, 0, 0],
  max_enu: [9, 9, 9],
  tiles: "tiles/tileset.json",
  cameras: [],
  photos: [],
  blocks: [],
  missing: [],
};

function stop(more: object = {}) {
  return {
    id: "s",
    title: "One",
    text: "",
    picture: PICTURE,
    link: null,
    pose: POSE,
    exposure_stops: null,
    layers: null,
    measurements: [],
    pause_s: 0,
    next: null,
    branches: [],
    ...more,
  };
}

function tour(more: object = {}, version = 1) {
  const assets = { [PICTURE]: { name: "a.png", bytes: 9 } };
  return { version, title: "Tour", start: null, stops: [stop(more)], things: [], assets };
}

function manifest(more: object = {}) {
  return { version: 1, missing: ["Something is left out."], stops: { s: { still: STILL, panorama: null } }, ...more };
}

/** A folder with these files; `asked` lists those that were wanted. */
function folder(contents: Readonly<Record<string, unknown>>): Files & { readonly asked: string[] } {
  const asked: string[] = [];
  const load = (name: string): Promise<Bytes> => {
    asked.push(name);
    const value = contents[name];
    if (value === undefined) return Promise.reject(new Error(`data/${name}.js could not be loaded`));
    return Promise.resolve(new TextEncoder().encode(typeof value === "string" ? value : JSON.stringify(value)));
  };
  return { asked, load, release: () => {} };
}

test("project, tour and pictures are read, and nothing else is asked for", async () => {
  const files = folder({ "project.json": PROJECT, "tour.json": tour(), "manifest.json": manifest() });
  const exported = await readExportedTour(files);
  assert.equal(exported.project.tiles, "/data/tiles/tileset.json");
  // Pictures take the part of the scene that frames are rendered from.
  assert.notEqual(exported.project.scene, null);
  assert.equal(exported.tour.stops[0]?.picture, PICTURE);
  assert.equal(exported.pictures.get("s")?.still?.width, 10);
  assert.deepEqual(exported.missing, ["Something is left out."]);
  assert.deepEqual([...files.asked].sort(), ["manifest.json", "project.json", "tour.json"]);
});

test("what the manifest does not list is not asked for, and told of by the manifest alone", async () => {
  const files = folder({
    "project.json": PROJECT,
    "tour.json": tour({ measurements: ["m1"] }),
    "manifest.json": manifest({ files: ["project.json"] }),
  });
  const { tour: read, missing, measurements } = await readExportedTour(files);
  assert.equal(read.stops[0]?.picture, null);
  assert.deepEqual(missing, ["Something is left out."]);
  assert.deepEqual(measurements, []);
  assert.ok(!files.asked.includes("measurements.geojson"));
});

test("a tour of another version plays, and measurements that are lost are told of", async () => {
  const files = folder({
    "project.json": PROJECT,
    "tour.json": tour({ measurements: ["m1"], hologram: 3 }, 2),
    "manifest.json": manifest(),
  });
  const { tour: read, missing } = await readExportedTour(files);
  assert.equal(read.stops.length, 1);
  assert.ok(missing.some((text) => /version 2/.test(text)));
  assert.match(missing.at(-1) ?? "", /^The measurements are not shown: data\/measurements\.geojson\.js/);
});

test("a damaged file is named, with the place in it", async () => {
  const good = { "project.json": PROJECT, "tour.json": tour(), "manifest.json": manifest() };
  for (const [bad, why] of [
    [{ "project.json": { ...PROJECT, min_enu: [0, 0] } }, /data\/project\.json\.js is damaged, min_enu: 3 numbers/],
    [{ "tour.json": tour({ pause_s: -1 }) }, /data\/tour\.json\.js is damaged, stops\[0\]\.pause_s/],
    [{ "manifest.json": "{" }, /data\/manifest\.json\.js is damaged, .*not valid JSON/],
    [{ "tour.json": undefined }, /data\/tour\.json\.js could not be loaded/],
  ] as const) {
    await assert.rejects(readExportedTour(folder({ ...good, ...bad })), why);
  }
});

test("the scene gets its files by the addresses of the viewer's server", async () => {
  const files = folder({ "tiles/a.glb": "abc" });
  const load = bytesOf(files);
  const { signal } = new AbortController();
  assert.equal(new TextDecoder().decode(await load("file:///data/tiles/a.glb", signal)), "abc");
  await assert.rejects(load("file:///elsewhere/a.glb", signal), /not in the folder of the tour/);
  await assert.rejects(load("/data/tiles/a.glb", AbortSignal.abort()), { name: "AbortError" });
});

test("buildings come from their file", async () => {
  await assert.rejects(
    buildingsOf(folder({}))("/data/buildings/buildings.json"),
    /buildings\/buildings\.json\.js could not/,
  );
  const wrong = folder({ "buildings/buildings.json": {} });
  await assert.rejects(buildingsOf(wrong)("/data/buildings/buildings.json"), /buildings\.json\.js is damaged/);
});
