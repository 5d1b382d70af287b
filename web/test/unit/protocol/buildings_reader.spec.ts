import assert from "node:assert/strict";
import test from "node:test";
import { CheckError } from "../../../src/base/check.js";
import { readBuildings } from "../../../src/protocol/buildings_reader.js";
import { boxSolid } from "../state/building_samples.js";

type Json = Record<string, unknown>;

function solidJson(): Json {
  const { vertices, faces } = boxSolid([0, 0, 1], [8, 6, 8]);
  return { vertex: vertices, face: faces.map(({ kind, rings: [outer] }) => ({ kind, outer, holes: [] })) };
}

function buildingJson(change: Json = {}): Json {
  return {
    id: 1,
    roof: "hip",
    accepted: false,
    note: 'only <b>70 %</b> of the "roof"',
    overhang_m: null,
    roof_points: 240,
    share_within: 0.7,
    given: false,
    given_id: "",
    measures: {
      ground_m: [1.12, 0.13],
      eave_m: [5.48, null],
      ridge_m: [8.42, 0.32],
      height_m: [7.3, 0.35],
      length_m: [8.4, 0.4],
      width_m: [6.3, 0.39],
      yaw_deg: [144.8, 3.1],
      footprint_m2: [52.7, 4.9],
      roof_m2: [72.2, 8.8],
      volume_m3: [288, 25],
      pitch_deg: [null, null],
      wall_seen: 0.19,
    },
    lod22: solidJson(),
    ...change,
  };
}

function file(change: Json = {}, buildings: unknown = [buildingJson()]): Json {
  return {
    format: "skyquilt buildings",
    version: 1,
    metric: true,
    scale_source: "geo-reference",
    buildings,
    ...change,
  };
}

function refused(value: unknown, place: RegExp): void {
  assert.throws(
    () => readBuildings(value),
    (error: unknown) => error instanceof CheckError && place.test(error.message),
    `${place} was not refused`,
  );
}

test("a whole file", () => {
  const set = readBuildings(file());
  assert.equal(set.metric, true);
  const [building] = set.buildings;
  assert.ok(building !== undefined);
  assert.deepEqual(building.measures.height, { value: 7.3, sigma: 0.35 });
  assert.deepEqual(building.measures.eave, { value: 5.48, sigma: null }, "a deviation may be unknown");
  assert.equal(building.measures.pitch, null);
  assert.deepEqual(building.measures.area, { value: 52.7, sigma: 4.9 });
  assert.equal(building.wallSeen, 0.19);
  assert.equal(building.note, 'only <b>70 %</b> of the "roof"');
  assert.deepEqual(building.solid, boxSolid([0, 0, 1], [8, 6, 8]));
  assert.deepEqual(readBuildings(file({}, [])).buildings, []);
});

test("holes come after the outline", () => {
  const solid = solidJson() as { face: { outer: number[]; holes: number[][] }[] };
  solid.face[0]?.holes.push([1, 5, 7]);
  const [building] = readBuildings(file({}, [buildingJson({ lod22: solid })])).buildings;
  assert.deepEqual(building?.solid.faces[0]?.rings, [
    [0, 2, 6, 4],
    [1, 5, 7],
  ]);
});

test("other files and versions are refused", () => {
  refused(null, /object expected/);
  refused([], /object expected/);
  refused(file({ format: "CityJSON" }), /^format/);
  refused(file({ version: 2 }), /^version/);
  refused(file({ metric: "yes" }), /^metric/);
  refused(file({}, {}), /^buildings: a list/);
});

test("what is wrong in a building is named with its place", () => {
  const one = (change: Json, place: RegExp) =>
    refused(file({}, [buildingJson(), buildingJson({ id: 2, ...change })]), place);
  one({ id: 1 }, /buildings\[1\]\.id: 1 is there twice/);
  one({ id: "2" }, /buildings\[1\]\.id/);
  one({ id: 2.5 }, /buildings\[1\]\.id/);
  one({ roof: "<script>" }, /buildings\[1\]\.roof: one of flat, gable, hip, other expected, found text/);
  one({ accepted: 1 }, /accepted/);
  one({ note: null }, /note/);
  one({ note: "x".repeat(100_000) }, /note/);
  one({ share_within: 1.5 }, /share_within/);
  one({ measures: {} }, /measures\.ground_m/);
  const measures = (change: Json) => ({ measures: { ...(buildingJson().measures as Json), ...change } });
  one(measures({ height_m: [7.3] }), /measures\.height_m/);
  one(measures({ height_m: [7.3, -1] }), /measures\.height_m\[1\]/);
  one(measures({ height_m: ["7.3", 1] }), /measures\.height_m\[0\]/);
  one(measures({ volume_m3: [1e300, 1] }), /measures\.volume_m3\[0\]/);
});

test("hostile solids are refused", () => {
  const solid = (change: Json, place: RegExp) =>
    refused(file({}, [buildingJson({ lod22: { ...solidJson(), ...change } })]), place);
  const face = (change: Json, place: RegExp) =>
    solid({ face: [{ kind: "roof", outer: [1, 5, 7, 3], holes: [], ...change }] }, place);
  refused(file({}, [buildingJson({ lod22: null })]), /lod22/);
  solid({ face: [] }, /lod22\.face: it is empty/);
  solid({ vertex: [] }, /outer\[0\]/);
  solid({ vertex: [[0, 0]] }, /vertex\[0\]/);
  solid({ vertex: [[0, 0, 1e30]] }, /vertex\[0\]\[2\]/);
  solid({ vertex: new Array(30_000).fill([0, 0, 0]) }, /vertex: at most/);
  face({ outer: [0, 1, 8] }, /outer\[2\]: 8 is too large/);
  face({ outer: [0, -1, 2] }, /outer\[1\]/);
  face({ outer: [0, 1.5, 2] }, /outer\[1\]/);
  face({ outer: [0, 1] }, /outer: at least 3 corners/);
  face({ holes: [[1, 2]] }, /holes\[0\]: at least 3 corners/);
  face({ holes: null }, /holes/);
  face({ kind: "window" }, /kind/);
});
