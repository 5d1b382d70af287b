import assert from "node:assert/strict";
import test from "node:test";
import { mapFromGeodetic } from "../../../src/geo/projection.js";
import { mergeControlPoints, readGcpList } from "../../../src/state/gcp_text.js";

const crs = { name: "EPSG:32632", zone: 32, north: true };
const photos = ["a/IMG_1.jpg", "b/IMG_1.jpg", "b/IMG_2.JPG"].map((name) => ({ name }));
const project = { crs, photos };

test("marks of one point are gathered; comments, tabs and line ends of Windows do not matter", () => {
  const text =
    "\uFEFFEPSG:32632\r\n# comment\r\n465412.34 5247012.3 409.12 310.25 152.5 b/IMG_2.JPG church\r\n465412.34\t5247012.3\t409.12\t5 6\ta/IMG_1.jpg\tchurch\r\n";
  const { points, problems } = readGcpList(text, project);
  assert.deepEqual(problems, []);
  assert.deepEqual(points, [
    {
      name: "church",
      xyz: [465412.34, 5247012.3, 409.12],
      marks: [
        { photo: "b/IMG_2.JPG", pixel: [310.25, 152.5] },
        { photo: "a/IMG_1.jpg", pixel: [5, 6] },
      ],
    },
  ]);
});

test("points without a name are told apart by their coordinates and get free names", () => {
  const text =
    "EPSG:32632\n1 2 3 4 5 b/IMG_2.JPG\n1 2 3 6 7 a/IMG_1.jpg\n9 2 3 4 5 b/IMG_2.JPG\n8 8 8 4 5 b/IMG_2.JPG GCP_1\n";
  assert.deepEqual(
    readGcpList(text, project, ["GCP_2", "GCP_9"]).points.map(({ name }) => name),
    ["GCP_3", "GCP_4", "GCP_1"],
  );
  const { points } = readGcpList(text, project);
  assert.deepEqual(
    points.map((point) => [point.name, point.marks.length]),
    [
      ["GCP_2", 2],
      ["GCP_3", 1],
      ["GCP_1", 1],
    ],
  );
});

test("a photo is found without its folder only when that is unambiguous", () => {
  const { points, problems } = readGcpList(
    "EPSG:32632\n1 2 3 4 5 img_2.jpg P\n1 2 3 4 5 IMG_1.jpg P\n1 2 3 4 5 none.jpg P\n",
    project,
  );
  assert.deepEqual(points[0]?.marks, [{ photo: "b/IMG_2.JPG", pixel: [4, 5] }]);
  assert.match(problems.join(" "), /2 photos are not in this project.*IMG_1\.jpg, none\.jpg/);
});

test("longitude and latitude, and another zone, are converted to the project's system", () => {
  const [easting, northing] = mapFromGeodetic(crs, 47.3769, 8.5417);
  const geographic = readGcpList("EPSG:4326\n8.5417 47.3769 409 1 2 b/IMG_2.JPG P\n", project).points[0];
  assert.ok(geographic);
  assert.ok(Math.hypot(geographic.xyz[0] - easting, geographic.xyz[1] - northing) < 1e-6);
  assert.equal(geographic.xyz[2], 409);
  const [e33, n33] = mapFromGeodetic({ zone: 33, north: true }, 47.3769, 8.5417);
  for (const first of ["WGS84 UTM 33N", "+proj=utm +zone=33 +datum=WGS84 +units=m", "epsg:32633"]) {
    const other = readGcpList(`${first}\n${e33} ${n33} 409 1 2 b/IMG_2.JPG P\n`, project).points[0];
    assert.ok(other);
    assert.ok(Math.hypot(other.xyz[0] - easting, other.xyz[1] - northing) < 1e-4, first);
  }
});

test("ETRS89 is taken as WGS84, and says so", () => {
  const { points, problems } = readGcpList("EPSG:25832\n1 2 3 4 5 b/IMG_2.JPG P\n", project);
  assert.deepEqual(points[0]?.xyz, [1, 2, 3]);
  assert.match(problems.join(), /ETRS89/);
});

test("lines that cannot be read are named, the others are used", () => {
  const text =
    "EPSG:32632\n1 2 3 4 5\n1 2 3 4 12abc b/IMG_2.JPG P\n1 2 NaN 4 5 b/IMG_2.JPG P\n1 2 3 4 5 b/IMG_2.JPG P\n";
  const { points, problems } = readGcpList(text, project);
  assert.equal(points.length, 1);
  assert.equal(points[0]?.marks.length, 1);
  assert.deepEqual(
    problems.map((problem) => problem.slice(0, 7)),
    ["Line 2 ", "Line 3 ", "Line 4 "],
  );
});

test("files of which nothing can be used are refused with the reason", () => {
  assert.throws(() => readGcpList("", project), /empty/);
  assert.throws(() => readGcpList("1 2 3 4 5 b/IMG_2.JPG P\n", project), /coordinate system/);
  assert.throws(() => readGcpList("EPSG:32699\n", project), /not known/);
  assert.throws(() => readGcpList("WGS84 UTM 61N\n", project), /not known/);
  assert.throws(() => readGcpList("EPSG:32632\n", project), /no points/);
  assert.throws(() => readGcpList("LOCAL\n1 2 3 4 5 b/IMG_2.JPG P\n", project), /local coordinates/);
  assert.throws(() => readGcpList("EPSG:32632\n1 2 3 4 5 b/IMG_2.JPG P\n", { crs: null, photos }), /no geo-reference/);
  assert.equal(readGcpList("LOCAL\n1 2 3 4 5 b/IMG_2.JPG P\n", { crs: null, photos }).points.length, 1);
});

test("loading again replaces marks in the same photos and keeps the others", () => {
  const mark = (photo: string, x: number) => ({ photo, pixel: [x, 0] as const });
  const merged = mergeControlPoints(
    [
      { name: "P", xyz: [0, 0, 0], marks: [mark("a", 1), mark("b", 1)] },
      { name: "Q", xyz: [1, 1, 1], marks: [] },
    ],
    [
      { name: "P", xyz: [5, 5, 5], marks: [mark("b", 2)] },
      { name: "R", xyz: [2, 2, 2], marks: [] },
    ],
  );
  assert.deepEqual(merged, [
    { name: "P", xyz: [5, 5, 5], marks: [mark("a", 1), mark("b", 2)] },
    { name: "Q", xyz: [1, 1, 1], marks: [] },
    { name: "R", xyz: [2, 2, 2], marks: [] },
  ]);
});
