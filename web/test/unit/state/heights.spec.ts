// The Earth's curvature in heights, and the vertical accuracy in volumes.
import assert from "node:assert/strict";
import test from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { enuFromGeodetic, geodeticFromEnu } from "../../../src/geo/earth.js";
import { levelAtOutlineM, outlineOffsetM, projectOffsetM } from "../../../src/geo/heights.js";
import { initialState } from "../../../src/state/initial.js";
import { newDistance, newProfile, replacePoint, withMeasurement } from "../../../src/state/measurements.js";
import { measureVolume, type VolumeSource } from "../../../src/state/volumes.js";
import { samplePoint, sampleProject } from "./samples.js";

const PROJECT = sampleProject();
const LOCAL = sampleProject({ georeferenced: false, crs: null });
const EMPTY = initialState(PROJECT).documents;

/** As far to the north, at the same height as the origin. */
function sameHeight(northM: number): Vec3 {
  const place = geodeticFromEnu(PROJECT, [0, northM, 0]);
  return enuFromGeodetic(PROJECT, { ...place, heightM: PROJECT.origin.heightM });
}

test("a height difference is one of heights, not of z of the flat frame", () => {
  const [near, far] = [samplePoint([0, 0, 0]), samplePoint(sameHeight(3000))];
  assert.ok(far.enu[2] < -0.6);
  const distance = newDistance(EMPTY, [near, far], PROJECT);
  assert.ok(distance.kind === "distance" && Math.abs(distance.result.rise.value) < 1e-6);
  const flat = newDistance(EMPTY, [near, far], LOCAL);
  assert.ok(flat.kind === "distance" && flat.result.rise.value === far.enu[2]);
  const mesh = samplePoint(far.enu, null);
  const documents = withMeasurement(EMPTY, newDistance(EMPTY, [near, mesh], PROJECT));
  const [better] = replacePoint(documents, mesh, far, PROJECT).measurements;
  assert.ok(better?.kind === "distance" && Math.abs(better.result.rise.value) < 1e-6);
});

test("a profile at one height above the Earth is level", () => {
  const points = [samplePoint(sameHeight(0)), samplePoint(sameHeight(4000))];
  const heightsM = [0, 1000, 2000, 3000, 4000].map((northM) => sameHeight(northM)[2]);
  const profile = newProfile(EMPTY, points, { lengthM: 4000, heightsM, spreadsM: [] }, PROJECT);
  assert.ok(profile.kind === "profile");
  for (const z of profile.heightsM) {
    assert.ok(Math.abs((z ?? 0) + outlineOffsetM(PROJECT, points) - PROJECT.origin.heightM) < 2e-3, String(z));
  }
});

test("the level of a volume has the height that was typed, wherever the outline lies", () => {
  const points = [sameHeight(5000), sameHeight(5010), sameHeight(5020)].map((enu) => samplePoint(enu));
  const z = 420 - projectOffsetM(PROJECT);
  assert.ok(Math.abs(levelAtOutlineM(PROJECT, points, z) + outlineOffsetM(PROJECT, points) - 420) < 1e-9);
  assert.ok(Math.abs(levelAtOutlineM(PROJECT, points, z) - z) > 1);
  assert.equal(levelAtOutlineM(LOCAL, points, 7), 7);
});

test("a volume over a fixed level or the earlier survey has the vertical accuracy times its area", async () => {
  const source: VolumeSource = {
    volume: async () => ({
      cellM: 1,
      filled: 1,
      planAreaM2: 50,
      surfaceAreaM2: 50,
      cutM3: 0,
      fillM3: 0,
      netM3: 0,
      sigmaM3: 30,
    }),
  };
  const points = [samplePoint([0, 0, 0]), samplePoint([10, 0, 0]), samplePoint([0, 10, 0])];
  const accuracy = { ...PROJECT.accuracy, verticalM: 0.8 };
  const project = { accuracy, before: { accuracy: { ...accuracy, verticalM: 0.6 } } };
  const sigma = async (base: "plane" | "height" | "before", of = project) =>
    Math.round(((await measureVolume(source, of, points, base, 0)).net.sigma ?? Number.NaN) * 1e6) / 1e6;
  assert.equal(await sigma("plane"), 30);
  assert.equal(await sigma("height"), 50);
  assert.equal(await sigma("before"), Math.round(Math.hypot(30, 50) * 1e6) / 1e6);
  const unknown = { ...project, accuracy: { ...accuracy, verticalM: null } };
  assert.equal(await sigma("height", unknown as unknown as typeof project), 30);
  const alone = { accuracy, before: null };
  await assert.rejects(measureVolume(source, alone, points, "plane", 0, "before"), /--compare/);
});
