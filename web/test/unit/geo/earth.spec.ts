import assert from "node:assert/strict";
import test from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { norm, sub, transformPoint } from "../../../src/base/vec_math.js";
import {
  ecefFromEnuMatrix,
  ecefFromGeodetic,
  enuFromEcefMatrix,
  enuFromGeodetic,
  type Geodetic,
  geodeticFromEcef,
  geodeticFromEnu,
  wrapLongitudeDeg,
} from "../../../src/geo/earth.js";
import { LOCAL, PLACES } from "./reference.js";

function geodetic([latitudeDeg, longitudeDeg, heightM]: Vec3): Geodetic {
  return { latitudeDeg, longitudeDeg, heightM };
}

for (const { name, place, ecef } of PLACES) {
  test(`ECEF as GeographicLib, and back: ${name}`, () => {
    const found = ecefFromGeodetic(...place);
    assert.ok(norm(sub(found, ecef)) < 2e-6, `${found} instead of ${ecef}`);
    const back = geodeticFromEcef(ecef);
    assert.ok(Math.abs(back.heightM - place[2]) < 2e-6, `height ${back.heightM}`);
    assert.ok(Math.abs(back.latitudeDeg - place[0]) < 3e-11, `latitude ${back.latitudeDeg}`);
    const again = ecefFromGeodetic(back.latitudeDeg, back.longitudeDeg, back.heightM);
    assert.ok(norm(sub(again, ecef)) < 2e-8);
    assert.ok(back.longitudeDeg >= -180 && back.longitudeDeg < 180);
  });
}

for (const { name, origin, place, enu } of LOCAL) {
  test(`ENU as GeographicLib, and back: ${name}`, () => {
    const project = { origin: geodetic(origin) };
    const found = enuFromGeodetic(project, geodetic(place));
    assert.ok(norm(sub(found, enu)) < 2e-6, `${found} instead of ${enu}`);
    const back = geodeticFromEnu(project, enu);
    assert.ok(norm(sub(enuFromGeodetic(project, back), enu)) < 1e-6);
    const ecef = transformPoint(ecefFromEnuMatrix(project.origin), enu);
    assert.ok(norm(sub(ecef, ecefFromGeodetic(...place))) < 2e-6);
    assert.ok(norm(sub(transformPoint(enuFromEcefMatrix(project.origin), ecef), enu)) < 1e-6);
  });
}

test("there and back over the whole Earth, from mine to orbit", () => {
  for (let lat = -90; lat <= 90; lat += 7.5) {
    for (let lon = -180; lon < 180; lon += 30) {
      for (const height of [-5000, 0, 8848, 2e6]) {
        const ecef = ecefFromGeodetic(lat, lon, height);
        const back = geodeticFromEcef(ecef);
        const again = ecefFromGeodetic(back.latitudeDeg, back.longitudeDeg, back.heightM);
        assert.ok(norm(sub(again, ecef)) < 1e-7, `${lat} ${lon} ${height}: ${again}`);
        assert.ok(Math.abs(back.latitudeDeg - lat) < 1e-11 && Math.abs(back.heightM - height) < 1e-7);
      }
    }
  }
});

test("the centre of the Earth is a place without NaN", () => {
  const { latitudeDeg, longitudeDeg, heightM } = geodeticFromEcef([0, 0, 0]);
  assert.ok([latitudeDeg, longitudeDeg, heightM].every(Number.isFinite));
});

test("longitudes wrap to [-180, 180)", () => {
  assert.equal(wrapLongitudeDeg(180), -180);
  assert.equal(wrapLongitudeDeg(-180), -180);
  assert.equal(wrapLongitudeDeg(540), -180);
  assert.equal(wrapLongitudeDeg(-190), 170);
  assert.equal(wrapLongitudeDeg(-180 - 1e-14), -180);
  assert.equal(wrapLongitudeDeg(8.5417), 8.5417);
});
