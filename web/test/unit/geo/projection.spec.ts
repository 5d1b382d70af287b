import assert from "node:assert/strict";
import test from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { norm, sub } from "../../../src/base/vec_math.js";
import { ecefFromGeodetic } from "../../../src/geo/earth.js";
import { enuFromMap, geodeticFromMap, mapFromEnu, mapFromGeodetic } from "../../../src/geo/projection.js";
import { PLACES } from "./reference.js";

for (const { name, place, zone, north, map } of PLACES) {
  test(`map coordinates as GeographicLib and PROJ, and back: ${name}`, () => {
    const found = mapFromGeodetic({ zone, north }, place[0], place[1]);
    assert.ok(Math.hypot(found[0] - map[0], found[1] - map[1]) < 2e-6, `${found} instead of ${map}`);
    const back = geodeticFromMap({ zone, north }, found);
    const off = norm(
      sub(ecefFromGeodetic(back.latitudeDeg, back.longitudeDeg, 0), ecefFromGeodetic(place[0], place[1], 0)),
    );
    assert.ok(off < 1e-6, `${off} m after a round trip`);
  });
}

test("there and back in every zone, also 15 degrees beyond it", () => {
  for (let zone = 1; zone <= 60; zone += 1) {
    for (const lat of [-85, -80, -33.3, -1e-9, 0, 45, 83.9, 89.9999]) {
      for (const beside of [-15, -3, 0, 2.9, 15]) {
        const lon = 6 * zone - 183 + beside;
        const back = geodeticFromMap({ zone, north: lat >= 0 }, mapFromGeodetic({ zone, north: lat >= 0 }, lat, lon));
        const off = norm(sub(ecefFromGeodetic(back.latitudeDeg, back.longitudeDeg, 0), ecefFromGeodetic(lat, lon, 0)));
        assert.ok(off < 1e-6, `zone ${zone}, ${lat}, ${lon}: ${off} m`);
      }
    }
  }
});

test("there and back around both poles", () => {
  for (const north of [true, false]) {
    for (const distance of [0, 1e-7, 0.01, 5, 12, 40, 95]) {
      for (let lon = -180; lon < 180; lon += 15) {
        const lat = north ? 90 - distance : distance - 90;
        const back = geodeticFromMap({ zone: 0, north }, mapFromGeodetic({ zone: 0, north }, lat, lon));
        const off = norm(sub(ecefFromGeodetic(back.latitudeDeg, back.longitudeDeg, 0), ecefFromGeodetic(lat, lon, 0)));
        assert.ok(off < 1e-6, `${lat}, ${lon}: ${off} m`);
      }
    }
  }
});

test("ENU to map and back; without a CRS there is no map", () => {
  const origin = { latitudeDeg: 47.3769, longitudeDeg: 8.5417, heightM: 408 };
  const project = { origin, crs: { zone: 32, north: true } };
  const enu: Vec3 = [-875.945733, 1000.748283, 91.861361];
  const xyz = mapFromEnu(project, enu);
  assert.ok(xyz !== null);
  const [e, n] = mapFromGeodetic(project.crs, 47.3859, 8.5301);
  assert.ok(norm(sub(xyz, [e, n, 500])) < 1e-5, String(xyz));
  const back = enuFromMap(project, xyz);
  assert.ok(back !== null && norm(sub(back, enu)) < 1e-6);
  assert.equal(mapFromEnu({ origin, crs: null }, enu), null);
  assert.equal(enuFromMap({ origin, crs: null }, enu), null);
});
