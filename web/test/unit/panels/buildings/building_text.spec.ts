import assert from "node:assert/strict";
import test from "node:test";
import type { Estimate } from "../../../../src/geo/measure.js";
import {
  buildingLines,
  buildingText,
  columnText,
  fileLabel,
  measuresNote,
  nextOrder,
  type SortKey,
  sortBuildings,
} from "../../../../src/panels/buildings/building_text.js";
import { type Building, type MeasureName, measureOf } from "../../../../src/state/buildings.js";
import { buildingsCsv } from "../../../../src/state/buildings_csv.js";
import { boxSolid, sampleBuilding, sampleSet } from "../../state/building_samples.js";
import { sampleProject } from "../../state/samples.js";

const LOCAL = sampleProject({ georeferenced: false, crs: null });
const WORLD = sampleProject();

function measured(
  id: number,
  measures: Partial<Record<MeasureName, Estimate>>,
  change: Partial<Building> = {},
): Building {
  const building = sampleBuilding(id, change);
  return { ...building, measures: { ...building.measures, ...measures } };
}

function textOf(lines: ReturnType<typeof buildingLines>, label: string): string | undefined {
  return lines.find((line) => line.label === label)?.text;
}

const HOUSE = measured(
  12,
  {
    ground: { value: 1.1, sigma: 0.13 },
    eave: { value: 5.5, sigma: 0.3 },
    ridge: { value: 8.4, sigma: 0.3 },
    height: { value: 7.2957, sigma: 0.3479 },
    length: { value: 8.412, sigma: 0.04 },
    area: { value: 52.73, sigma: 4.9 },
    yaw: { value: 144.836, sigma: 3.07 },
    pitch: { value: 43.1, sigma: 0.012 },
  },
  { roof: "gable" },
);

test("every measure has ±, units only when they are known", () => {
  const lines = buildingLines(HOUSE, sampleSet([HOUSE]), WORLD);
  assert.equal(textOf(lines, "Height"), "7.3 m ± 0.3 m");
  assert.equal(textOf(lines, "Length"), "8.41 m ± 0.04 m");
  assert.equal(textOf(lines, "Footprint"), "53 m² ± 5 m²");
  assert.equal(textOf(lines, "Direction"), "145° ± 3°");
  assert.equal(textOf(lines, "Roof pitch"), "43.100° ± 0.012°");
  assert.equal(textOf(lines, "Volume"), "unknown");
  const bare = sampleSet([HOUSE], { metric: false, scaleSource: "unknown" });
  const unscaled = buildingLines(HOUSE, bare, LOCAL);
  assert.equal(textOf(unscaled, "Height"), "7.3 ± 0.3");
  assert.equal(textOf(unscaled, "Roof pitch"), "43.100° ± 0.012°");
  assert.ok(!buildingText(HOUSE, bare, LOCAL).match(/\d m\b|m²|m³/), "a unit nobody knows");
  assert.match(measuresNote(bare, LOCAL), /--scale-bar/);
});

test("flat roofs have a deck, pitched ones eave, ridge and pitch", () => {
  const labels = (building: Building) =>
    buildingLines(building, sampleSet([building]), WORLD).map(({ label }) => label);
  assert.ok(labels(HOUSE).includes("Eave") && labels(HOUSE).includes("Ridge"));
  const flat = labels({ ...HOUSE, roof: "flat" });
  assert.ok(flat.includes("Roof") && !flat.includes("Eave") && !flat.includes("Roof pitch"));
});

test("heights are those of the survey's system, one above the other as measured", () => {
  const far = { ...HOUSE, solid: boxSolid([4000, 0, 1], [4010, 8, 9]) };
  const [ground, ridge] = [measureOf(far, "ground", WORLD), measureOf(far, "ridge", WORLD)];
  assert.ok(ground !== null && ridge !== null);
  // The Earth curves away by 1.26 m at 4 km.
  assert.ok(Math.abs(ground.value - (408.25 + 1.1 + 1.26)) < 0.01, `${ground.value}`);
  assert.ok(Math.abs(ridge.value - ground.value - 7.3) < 1e-9);
  assert.equal(measureOf(far, "ground", LOCAL)?.value, 1.1);
  assert.equal(measureOf(far, "height", WORLD)?.value, 7.2957);
});

test("columns sort both ways, unknown last, equal ones by number", () => {
  const height = (value: number): Partial<Record<MeasureName, Estimate>> => ({ height: { value, sigma: null } });
  const list = [measured(4, height(5)), measured(2, {}), measured(1, height(9)), measured(3, height(5))];
  const ids = (key: SortKey, descending: boolean) => sortBuildings(list, { key, descending }).map(({ id }) => id);
  assert.deepEqual(ids("height", true), [1, 3, 4, 2]);
  assert.deepEqual(ids("height", false), [3, 4, 1, 2]);
  assert.deepEqual(ids("id", false), [1, 2, 3, 4]);
  assert.deepEqual(ids("id", true), [4, 3, 2, 1]);
  const order = nextOrder({ key: "id", descending: false }, "height");
  assert.deepEqual(order, { key: "height", descending: true });
  assert.deepEqual(nextOrder(order, "height"), { key: "height", descending: false });
});

test("the table as CSV has the columns of buildings.csv and text that no spreadsheet runs", () => {
  const odd = { ...HOUSE, note: '=HYPERLINK("x"), no walls', accepted: false };
  const [head = "", row = ""] = buildingsCsv([odd], true, LOCAL).split("\r\n");
  assert.match(head, /^id,ground_m,ground_m_sigma,eave_m,.*,area_m2,area_m2_sigma,.*,wall_seen,roof,accepted,note$/);
  assert.ok(row.startsWith("12,1.1,0.13,5.5,0.3,8.4,0.3,7.2957,0.3479,8.412,0.04,,,144.836,3.07,52.73,4.9,"));
  assert.ok(row.endsWith(`,0.5,gable,0,"'=HYPERLINK(""x""), no walls"`), row);
  const [bare = ""] = buildingsCsv([odd], false, LOCAL).split("\r\n");
  assert.match(bare, /^id,ground,ground_sigma,.*,yaw_deg,yaw_deg_sigma,area,area_sigma/);
});

test("short texts", () => {
  assert.equal(columnText(HOUSE, "height"), "7.30");
  assert.equal(columnText(HOUSE, "area"), "52.7");
  assert.equal(columnText(HOUSE, "width"), "–");
  assert.equal(fileLabel("/data/buildings/buildings.city.json"), "CityJSON");
  assert.equal(fileLabel("/data/buildings/buildings.csv"), "CSV");
  assert.equal(fileLabel("/data/buildings/other.bin"), "other.bin");
});
