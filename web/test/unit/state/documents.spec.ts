import assert from "node:assert/strict";
import test from "node:test";
import { CheckError } from "../../../src/base/check.js";
import type { Vec3 } from "../../../src/base/vec.js";
import { angleBetweenRad, norm, sub } from "../../../src/base/vec_math.js";
import { rotationFromAngles } from "../../../src/geo/camera.js";
import type { Documents, Measurement, SurfacePoint, VolumeBase } from "../../../src/state/app_state.js";
import { fovAcrossDeg } from "../../../src/state/camera_path.js";
import { readCameraPath, writeCameraPath } from "../../../src/state/camera_path_file.js";
import { readLoadedPoints } from "../../../src/state/control_file.js";
import { initialState } from "../../../src/state/initial.js";
import {
  newArea,
  newDistance,
  newPoint,
  newProfile,
  newVolume,
  withMeasurement,
} from "../../../src/state/measurements.js";
import {
  DOCUMENT_FILES,
  documentPart,
  documentRemark,
  readDocument,
  writeDocument,
} from "../../../src/state/persistence.js";
import { NO_ACCURACY, samplePoint, sampleProject, seededRandom } from "./samples.js";

const EMPTY = initialState(sampleProject()).documents;
const LOCAL = sampleProject({ georeferenced: false, crs: null });

/** Documents of all kinds, other ones for every seed. */
function randomDocuments(seed: number): Documents {
  const random = seededRandom(seed);
  const within = (low: number, high: number) => low + (high - low) * random();
  const name = () =>
    ["wall", "=1+1", '"quoted", text', "Größe 測量 🌲", "a\\b/c", " "][Math.floor(6 * random())] ?? "x";
  const point = (): SurfacePoint =>
    samplePoint([within(-500, 500), within(-500, 500), within(-20, 90)], random() < 0.3 ? null : within(0, 0.5), [
      within(-1, 1),
      within(-1, 1),
      -0.5,
    ]);
  const points = (count: number) => Array.from({ length: count }, point);
  const samples = Array.from({ length: 40 }, () => (random() < 0.2 ? null : within(-5, 60)));
  const survey = () => (random() < 0.5 ? "before" : "main");
  const base = (["plane", "lowest", "height", "before"] as const)[Math.floor(4 * random())] ?? "plane";
  const result = {
    cut: within(0, 100),
    fill: within(0, 100),
    net: { value: within(-100, 100), sigma: random() < 0.5 ? null : within(0, 9) },
    surfaceArea: within(0, 500),
    filled: random(),
    cellM: within(0.05, 1),
  };
  const makers: ((documents: Documents) => Measurement)[] = [
    (documents) => newPoint(documents, points(1)),
    (documents) => newDistance(documents, points(2 + Math.floor(5 * random())), LOCAL),
    (documents) =>
      newProfile(
        documents,
        points(2),
        {
          lengthM: within(1, 90),
          heightsM: samples,
          spreadsM: samples.map((z) => (z === null ? null : 0.1)),
        },
        LOCAL,
        survey(),
      ),
    (documents) => newArea(documents, points(3 + Math.floor(5 * random())), NO_ACCURACY),
    (documents) =>
      newVolume(documents, points(4), base as VolumeBase, base === "height" ? within(-5, 50) : null, result, survey()),
  ];
  let documents = EMPTY;
  for (const make of [...makers, ...makers]) {
    const measurement = { ...make(documents), name: name() };
    documents = withMeasurement(documents, measurement);
  }
  return {
    ...documents,
    controlPoints: [1, 2, 3].map((number) => ({
      name: `${name()} ${number}`,
      xyz: [within(4e5, 5e5), within(5e6, 6e6), within(0, 900)],
      marks: [1, 2].map((photo) => ({
        photo: `dir/DJI_${photo}.JPG`,
        pixel: [within(0, 4000), within(0, 3000)] as const,
        ...(random() < 0.3 ? { unknown: true as const } : {}),
      })),
    })),
    cameraPath: {
      speedMps: within(0.5, 20),
      keys: [1, 2, 3, 4].map(() => ({
        name: name(),
        pose: {
          eyeEnu: [within(-200, 200), within(-200, 200), within(10, 120)],
          rotation: rotationFromAngles({ yawDeg: within(0, 360), pitchDeg: within(-90, 30), rollDeg: within(-20, 20) }),
          fovyDeg: within(10, 100),
          orthoHeightM: random() < 0.3 ? within(1, 400) : null,
        },
      })),
    },
  };
}

test("measurements and control points come back from their files exactly", () => {
  for (let seed = 1; seed <= 20; seed += 1) {
    const documents = randomDocuments(seed);
    for (const project of [sampleProject(), LOCAL]) {
      for (const file of ["measurements.geojson", "gcp.json"] as const) {
        const read = readDocument(EMPTY, file, writeDocument(documents, file, project), project);
        assert.deepEqual(documentPart(read, file), documentPart(documents, file));
      }
    }
  }
});

test("a camera path comes back with the same views, names and speed", () => {
  for (let seed = 1; seed <= 20; seed += 1) {
    const { cameraPath } = randomDocuments(seed);
    const read = readCameraPath(JSON.parse(writeCameraPath(cameraPath)), LOCAL);
    assert.equal(read.speedMps, cameraPath.speedMps);
    assert.equal(read.keys.length, cameraPath.keys.length);
    read.keys.forEach(({ name, pose }, i) => {
      const key = cameraPath.keys[i];
      assert.ok(key !== undefined);
      assert.equal(name, key.name);
      assert.deepEqual(pose.eyeEnu, key.pose.eyeEnu);
      assert.ok(angleBetweenRad(pose.rotation, key.pose.rotation) < 1e-9);
      assert.ok(Math.abs(pose.fovyDeg - key.pose.fovyDeg) < 1e-9);
      assert.equal(pose.orthoHeightM, key.pose.orthoHeightM);
    });
  }
});

test("angles of a camera path are written without the noise of their last bits", () => {
  const rotation = rotationFromAngles({ yawDeg: 125, pitchDeg: -40, rollDeg: 0 });
  const pose = { eyeEnu: [0, 0, 9] as const, rotation, fovyDeg: 50, orthoHeightM: null };
  const [view] = JSON.parse(writeCameraPath({ keys: [{ name: "a", pose }], speedMps: 1 })).views;
  assert.deepEqual([view.yaw, view.pitch, Math.abs(view.roll)], [125, -40, 0]);
});

test("lines of a gcp_list.txt that were left out are told", () => {
  const text = (more: object) => JSON.stringify({ crs: null, points: [], ...more });
  const remarks = ["line 2: 'x' is not a number", "line 4: has 5 fields instead of 6 or more"];
  assert.match(documentRemark("gcp.json", text({ skipped: 3, remarks })), /3 lines.*; line 2: 'x' is.*; line 4: has 5/);
  assert.equal(documentRemark("gcp.json", text({})), "");
  assert.equal(documentRemark("camera_path.json", "{}"), "");
});

test("points of a loaded list get names that are free, and lose marks in photos that are not here", () => {
  const mark = { photo: "a.jpg", pixel: [1, 2] };
  const point = (name: string, ...marks: object[]) => ({ name, x: 1, y: 2, z: 3, marks });
  const points = [point("", mark, { ...mark, photo: "none.jpg", unknown: true }), point("GCP_1"), point("", mark)];
  const text = (more: object) => JSON.stringify({ crs: null, ...more });
  const loaded = readLoadedPoints(text({ points }), LOCAL, ["GCP_2", "GCP_9"]);
  assert.deepEqual(
    loaded.points.map(({ name, marks }) => [name, marks]),
    [
      ["GCP_3", [mark]],
      ["GCP_1", []],
      ["GCP_4", [mark]],
    ],
  );
  assert.match(loaded.remark, /^1 photos are not in this project.*none\.jpg$/);
  assert.throws(() => readLoadedPoints(text({ points: [] }), LOCAL, []), /no points/);
  assert.throws(
    () => readLoadedPoints(text({ points: [], skipped: 1, remarks: ["line 2: bad"] }), LOCAL, []),
    /line 2: bad/,
  );
});

test("empty documents come back", () => {
  for (const file of DOCUMENT_FILES) {
    assert.deepEqual(readDocument(EMPTY, file, writeDocument(EMPTY, file, LOCAL), LOCAL), EMPTY);
  }
});

test("the GeoJSON is what RFC 7946 asks for", () => {
  const project = sampleProject();
  const corners: readonly Vec3[] = [
    [0, 0, 1],
    [0, 10, 1],
    [10, 10, 1],
  ];
  // Clockwise.
  let documents = withMeasurement(
    EMPTY,
    newArea(
      EMPTY,
      corners.map((enu) => samplePoint(enu)),
      NO_ACCURACY,
    ),
  );
  documents = withMeasurement(documents, newPoint(documents, [samplePoint([0, 0, 0])]));
  const json = JSON.parse(writeDocument(documents, "measurements.geojson", project));
  assert.equal(json.type, "FeatureCollection");
  const [polygon, point] = json.features;
  const ring = polygon.geometry.coordinates[0];
  assert.equal(polygon.geometry.type, "Polygon");
  assert.deepEqual(ring[0], ring[3]);
  const [a, b, c] = ring;
  assert.ok((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0, "turns to the left");
  assert.ok(Math.abs(polygon.properties.plan_area_m2 - 50) < 1e-9);
  assert.ok(polygon.properties.plan_area_sigma_m2 > 0);
  const [longitude, latitude, height] = point.geometry.coordinates;
  assert.ok(
    Math.abs(longitude - 8.5417) < 1e-9 && Math.abs(latitude - 47.3769) < 1e-9 && Math.abs(height - 408.25) < 1e-6,
  );
  assert.ok(point.properties.vertical_sigma_m > 2);
  assert.equal(point.properties.crs, "EPSG:32632");
  const local = JSON.parse(writeDocument(documents, "measurements.geojson", LOCAL));
  assert.deepEqual(local.features[1].geometry.coordinates, [0, 0, 0]);
});

test("measurements stay where they are on Earth when the project's origin has moved", () => {
  const project = sampleProject();
  const { latitudeDeg, longitudeDeg, heightM } = project.origin;
  const moved = sampleProject({
    origin: { latitudeDeg: latitudeDeg + 1e-4, longitudeDeg: longitudeDeg - 1e-4, heightM: heightM + 30 },
  });
  const point = samplePoint([20, 30, 5]);
  let documents = withMeasurement(EMPTY, newPoint(EMPTY, [point]));
  const profile = { lengthM: 5, heightsM: [5, null], spreadsM: [0.1, null] };
  documents = withMeasurement(documents, newProfile(documents, [point, samplePoint([25, 30, 5])], profile, project));
  const text = writeDocument(documents, "measurements.geojson", project);
  const read = readDocument(EMPTY, "measurements.geojson", text, moved).measurements;
  const enu = read[0]?.points[0]?.enu;
  assert.ok(enu !== undefined);
  // 1e-4 degrees are 11.1 m to the north and 7.5 m to the east there.
  assert.ok(norm(sub(enu, [20 + 7.55, 30 - 11.12, -25])) < 0.1, String(enu));
  assert.ok(read[1]?.kind === "profile" && Math.abs((read[1].heightsM[0] ?? 0) + 25) < 0.01);
  assert.throws(() => readDocument(EMPTY, "measurements.geojson", text, LOCAL), /geo-reference/);
});

test("what is wrong in a file is named by its place, and nothing broken is written", () => {
  const project = sampleProject();
  const documents = randomDocuments(5);
  const broken = (file: (typeof DOCUMENT_FILES)[number], change: (json: never) => void) => {
    const json = JSON.parse(writeDocument(documents, file, project)) as never;
    change(json);
    try {
      readDocument(EMPTY, file, JSON.stringify(json), project);
    } catch (error) {
      assert.ok(error instanceof CheckError);
      return error.path;
    }
    return "nothing";
  };
  type Json = { [key: string]: never } & never[];
  const set = (path: readonly (string | number)[], value: unknown) => (json: never) => {
    let place = json as Json;
    for (const key of path.slice(0, -1)) place = place[key as never] as never;
    place[path[path.length - 1] as never] = value as never;
  };
  const cases: [(typeof DOCUMENT_FILES)[number], (string | number)[], unknown, string][] = [
    ["measurements.geojson", ["type"], "Feature", "type"],
    ["measurements.geojson", ["skyquilt", "version"], 2, "skyquilt.version"],
    ["measurements.geojson", ["features", 1, "id"], "m1", "features[1].id"],
    ["measurements.geojson", ["features", 1, "properties", "kind"], "line", "features[1].properties.kind"],
    ["measurements.geojson", ["features", 1, "properties", "slope_m"], "12", "features[1].properties.slope_m"],
    ["measurements.geojson", ["features", 1, "skyquilt", "points"], [], "features[1].skyquilt.points"],
    [
      "measurements.geojson",
      ["features", 0, "skyquilt", "points", 0, "enu"],
      [1, 2],
      "features[0].skyquilt.points[0].enu",
    ],
    ["measurements.geojson", ["features", 2, "skyquilt", "spreads_m"], [1], "features[2].skyquilt.spreads_m"],
    ["gcp.json", ["crs"], "EPSG:32633", "crs"],
    ["gcp.json", ["points", 0, "x"], null, "points[0].x"],
    ["gcp.json", ["points", 1, "marks", 0, "pixel"], [1], "points[1].marks[0].pixel"],
    ["camera_path.json", ["views"], {}, "views"],
    ["camera_path.json", ["views", 0, "fov"], 180, "views[0].fov"],
    ["camera_path.json", ["views", 2, "speed"], 1, "views[2]"],
    ["camera_path.json", ["skyquilt", "speed_mps"], 0, "skyquilt.speed_mps"],
  ];
  for (const [file, path, value, expected] of cases)
    assert.equal(broken(file, set(path, value)), expected, path.join("."));
  for (const file of DOCUMENT_FILES) {
    assert.throws(() => readDocument(EMPTY, file, "{", project), /not valid JSON/);
    assert.throws(() => readDocument(EMPTY, file, "null", project), CheckError);
  }
  const nan = withMeasurement(EMPTY, newPoint(EMPTY, [samplePoint([Number.NaN, 0, 0])]));
  assert.throws(() => writeDocument(nan, "measurements.geojson", project), /features\[0\].*not finite/);
});

test("views have what `skyquilt render --path` allows: names once, no paths, fov across the width", () => {
  const { cameraPath } = randomDocuments(1);
  const names = ["a/b", "a\\b", "..", "", "view_00001", "Same", "same", "ok\u0007"];
  const keys = names.map((name) => ({ name, pose: { ...(cameraPath.keys[0]?.pose ?? assert.fail()), fovyDeg: 40 } }));
  const json = JSON.parse(writeCameraPath({ keys, speedMps: 1 }));
  const written: string[] = json.views.map((view: { name: string }) => view.name);
  assert.equal(new Set(written.map((name) => name.toLowerCase())).size, names.length);
  for (const name of written)
    assert.ok(name !== "" && !/[/\\]/.test(name) && !name.startsWith(".") && !/^view_\d+$/.test(name), name);
  const allowed = ["position_enu", "longitude", "latitude", "height", "yaw", "pitch", "roll", "fov", "name"];
  for (const view of json.views) assert.ok(Object.keys(view).every((key) => allowed.includes(key)));
  assert.ok(Math.abs(json.views[0].fov - fovAcrossDeg(40, 16 / 9)) < 1e-9);
  assert.ok(Number.isInteger(json.frames_between));
  assert.deepEqual(
    readCameraPath(json, LOCAL).keys.map(({ name }) => name),
    names,
  );
});

test("paths that people wrote are read: a plain list, places on Earth, angles left out, names changed by hand", () => {
  const project = sampleProject();
  const { latitudeDeg, longitudeDeg, heightM } = project.origin;
  const list = [
    { latitude: latitudeDeg, longitude: longitudeDeg, height: heightM + 50, pitch: -90 },
    { position_enu: [1, 2, 3] },
  ];
  const { keys } = readCameraPath(list, project);
  assert.deepEqual(
    keys.map(({ name }) => name),
    ["Key 1", "Key 2"],
  );
  assert.ok(norm(sub(keys[0]?.pose.eyeEnu ?? [0, 0, 0], [0, 0, 50])) < 1e-6);
  assert.ok(Math.abs(fovAcrossDeg(keys[1]?.pose.fovyDeg ?? 0, 16 / 9) - 60) < 1e-9);
  assert.throws(() => readCameraPath(list, LOCAL), /no geo-reference/);
  const { cameraPath } = randomDocuments(2);
  const json = JSON.parse(writeCameraPath(cameraPath));
  json.views[1].name = "by hand";
  json.views.pop();
  const edited = readCameraPath(json, project);
  assert.equal(edited.keys.length, 3);
  assert.equal(edited.keys[1]?.name, "by hand");
  assert.equal(edited.keys[0]?.name, cameraPath.keys[0]?.name);
});
