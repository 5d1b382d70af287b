import assert from "node:assert/strict";
import test from "node:test";
import { CheckError } from "../../../src/base/check.js";
import { readProject } from "../../../src/protocol/project_reader.js";
import { dataUrl, readServerText } from "../../../src/protocol/replies.js";

function description(): Record<string, unknown> {
  return {
    name: "t11",
    revision: 3,
    georeferenced: true,
    origin: { latitude_deg: 47.3769, longitude_deg: 8.5417, height_m: 408 },
    crs: { name: "EPSG:32632", zone: 32, north: true },
    vertical: "ellipsoid WGS84",
    accuracy: { scale_percent: 0.01, tilt_deg: null, yaw_deg: 0, horizontal_m: 0.5, vertical_m: null },
    min_enu: [-10, -20, -1],
    max_enu: [10, 20, 30],
    ground_m: 0.5,
    gsd_m: 0.05,
    scene: { blocks: 4, parameters: 1000000, trust: true },
    tiles: "tiles/tileset.json",
    terrain: null,
    orthophoto: "orthophoto.jpg?r=3",
    points: "points.bin",
    surface: { triangles: 5, points: 4, area_m2: 3.5, voxel_m: 0.2 },
    blocks: [{ name: "b0", min_enu: [0, 0, 0], max_enu: [1, 1, 1], empty: false, photos: 9, psnr_db: null }],
    cameras: [{ model: "SIMPLE_RADIAL", width: 640, height: 360, params: [457, 320, 180, -0.02] }],
    photos: [
      {
        name: "a.jpg",
        camera: 0,
        position: [1, 2, 3],
        rotation: [0, 1, 0, 0],
        is_test: false,
        psnr_db: 25,
        available: true,
      },
      {
        name: "<b>.jpg",
        camera: 0,
        position: [1, 2, 3],
        rotation: [1, 0, 0, 0],
        is_test: true,
        psnr_db: null,
        available: false,
      },
    ],
    metrics: { psnr: 25.5, ssim: null, note: "text", list: [1] },
    before: null,
    missing: [{ what: "contours", reason: "not made", advice: "skyquilt dsm" }],
  };
}

test("buildings are files of this server", () => {
  const files = ["buildings/buildings.csv", "buildings/buildings.gpkg"];
  const buildings = { count: 60, url: "buildings/buildings.json", files };
  const read = (value: unknown) => readProject({ ...description(), buildings: value }).buildings;
  assert.deepEqual(read(buildings), {
    count: 60,
    url: "/data/buildings/buildings.json",
    files: ["/data/buildings/buildings.csv", "/data/buildings/buildings.gpkg"],
  });
  assert.equal(read(null), null);
  assert.equal(read(undefined), null, "an older program does not know them");
  for (const wrong of [
    { ...buildings, url: "https://evil.example/b.json" },
    { ...buildings, url: "../config.toml" },
    { ...buildings, count: -1 },
    { ...buildings, files: ["javascript:alert(1)"] },
    { ...buildings, files: null },
    [],
  ]) {
    assert.throws(() => read(wrong), /^CheckError: buildings/, JSON.stringify(wrong));
  }
});

test("a whole description", () => {
  const project = readProject(description());
  assert.equal(project.name, "t11");
  assert.deepEqual(project.origin, { latitudeDeg: 47.3769, longitudeDeg: 8.5417, heightM: 408 });
  assert.deepEqual(project.accuracy, {
    scalePercent: 0.01,
    tiltDeg: null,
    yawDeg: 0,
    horizontalM: 0.5,
    verticalM: null,
  });
  assert.equal(project.tiles, "/data/tiles/tileset.json");
  assert.equal(project.orthophoto, "/data/orthophoto.jpg?r=3");
  assert.equal(project.terrain, null);
  assert.equal(project.contours, null, "a key that is not there is null");
  assert.deepEqual(
    project.photos.map(({ index, name, isTest }) => [index, name, isTest]),
    [
      [0, "a.jpg", false],
      [1, "<b>.jpg", true],
    ],
  );
  assert.deepEqual(project.metrics, { psnr: 25.5, ssim: null });
  assert.equal(project.before, null);
});

test("the earlier project has its files below before/", () => {
  const turn = [1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1];
  const before = { ...description(), points: "before/points.bin", enu_from_before: turn };
  const project = readProject({ ...description(), before });
  assert.equal(project.before?.tiles, "/data/before/tiles/tileset.json");
  assert.equal(project.before?.points, "/data/before/points.bin");
  assert.deepEqual(project.before?.enuFromBefore, turn);
});

test("a project without photos, scene and geo-reference opens", () => {
  const bare = {
    ...description(),
    georeferenced: false,
    crs: null,
    accuracy: null,
    gsd_m: null,
    ground_m: null,
    scene: null,
  };
  const project = readProject({ ...bare, surface: null, metrics: null, blocks: [], cameras: [], photos: [] });
  assert.ok(project.crs === null && project.scene === null && project.accuracy.scalePercent === null);
  assert.ok(project.gsdM > 0);
  assert.equal(project.groundM, -1);
});

test("what is wrong is named with its place", () => {
  const cases: readonly (readonly [(o: Record<string, unknown>) => void, RegExp])[] = [
    [(o) => delete o.name, /^name: text expected, found nothing/],
    [
      (o) => Object.assign(o, { photos: [{ ...(o.photos as object[])[0], rotation: [0, 0, 0, 0] }] }),
      /^photos\[0\]\.rotation/,
    ],
    [(o) => Object.assign(o, { photos: [{ ...(o.photos as object[])[0], camera: 1 }] }), /^photos\[0\]\.camera/],
    [(o) => Object.assign(o, { origin: { latitude_deg: 91, longitude_deg: 0, height_m: 0 } }), /^origin\.latitude_deg/],
    [(o) => Object.assign(o, { max_enu: [-11, 20, 30] }), /^max_enu/],
    [(o) => Object.assign(o, { min_enu: [0, 0, null] }), /^min_enu\[2\]/],
    [(o) => Object.assign(o, { tiles: "//example.org/x" }), /^tiles/],
    [(o) => Object.assign(o, { crs: { name: "x", zone: 61, north: true } }), /^crs\.zone/],
    [(o) => Object.assign(o, { before: { ...description(), enu_from_before: [1] } }), /^before\.enu_from_before/],
    [(o) => Object.assign(o, { before: { ...description(), revision: "3" } }), /^before\.revision/],
  ];
  for (const [spoil, what] of cases) {
    const o = description();
    spoil(o);
    assert.throws(
      () => readProject(o),
      (error: unknown) => error instanceof CheckError && what.test(error.message),
      String(what),
    );
  }
});

test("addresses stay on this server, below /data/", () => {
  assert.equal(dataUrl("pictures/3.png", "url", "/data/"), "/data/pictures/3.png");
  for (const wrong of [
    "/x",
    "../x",
    "a/../x",
    "a//x",
    "http://x/y",
    "//x",
    "javascript:alert(1)",
    "",
    "a b",
    "a\\b",
    3,
  ]) {
    assert.throws(() => dataUrl(wrong, "url", "/data/"), CheckError, String(wrong));
  }
});

test("answers of the server: null where nothing is known, refused where it may not be", () => {
  const profile = { type: "profile", id: 1, length_m: 5, heights_m: [1, null, 2], spreads_m: [0.1, null, null] };
  const read = readServerText(JSON.stringify(profile));
  assert.ok(read?.type === "profile");
  assert.deepEqual(read.value, { lengthM: 5, heightsM: [1, null, 2], spreadsM: [0.1, null, null] });
  assert.throws(() => readServerText(JSON.stringify({ ...profile, spreads_m: [1] })), /spreads_m/);
  const nothing = {
    type: "picked",
    id: 1,
    hit: false,
    point: [null, null, null],
    depth_m: null,
    spread_m: null,
    opacity: 0,
  };
  const picked = readServerText(JSON.stringify(nothing));
  assert.ok(picked?.type === "picked" && !picked.value.hit);
  assert.throws(() => readServerText(JSON.stringify({ ...nothing, hit: true })), /point\[0\]/);
  assert.equal(readServerText('{"type":"news"}'), null);
  for (const wrong of ["", "[]", "null", "3", '{"type":3}', '{"type":"progress","id":-1,"fraction":0}']) {
    assert.throws(() => readServerText(wrong), CheckError, wrong);
  }
});
