import assert from "node:assert/strict";
import test from "node:test";
import { csvText, measurementsCsv, profileCsv } from "../../../src/state/csv.js";
import { initialState } from "../../../src/state/initial.js";
import { newArea, newDistance, newProfile, withMeasurement } from "../../../src/state/measurements.js";
import { NO_ACCURACY, samplePoint, sampleProject } from "./samples.js";

/** Cells of CSV text, by RFC 4180. */
function parse(text: string): string[][] {
  const rows: string[][] = [[]];
  let cell = "";
  let quoted = false;
  for (let i = 0; i < text.length; i += 1) {
    const c = text[i] ?? "";
    if (quoted) {
      if (c !== '"') cell += c;
      else if (text[i + 1] === '"') cell += text[++i];
      else quoted = false;
    } else if (c === '"') quoted = true;
    else if (c === ",") {
      rows[rows.length - 1]?.push(cell);
      cell = "";
    } else if (c === "\r" && text[i + 1] === "\n") {
      rows[rows.length - 1]?.push(cell);
      cell = "";
      rows.push([]);
      i += 1;
    } else cell += c;
  }
  assert.equal(quoted, false);
  assert.deepEqual(rows.pop(), []);
  return rows;
}

test("cells are quoted, formulas become text, numbers stay numbers", () => {
  const text = csvText([
    ['a "b", c', "two\r\nlines", null, -1.5, Number.NaN],
    ["=SUM(A1)", "+1", "-x", "@cmd", " =1"],
    ["\t=1", "plain", "a=b", "", "Größe"],
  ]);
  assert.deepEqual(parse(text), [
    ['a "b", c', "two\r\nlines", "", "-1.5", ""],
    ["'=SUM(A1)", "'+1", "'-x", "'@cmd", "' =1"],
    ["'\t=1", "plain", "a=b", "", "Größe"],
  ]);
});

test("one row per measurement with its shape as WKT", () => {
  const project = sampleProject({ georeferenced: false, crs: null });
  let documents = initialState(project).documents;
  const corners = [samplePoint([0, 0, 0]), samplePoint([3, 4, 0]), samplePoint([-3, 4, 0])];
  documents = withMeasurement(documents, {
    ...newDistance(documents, corners.slice(0, 2), sampleProject({ accuracy: NO_ACCURACY })),
    name: "-wall",
  });
  documents = withMeasurement(documents, newArea(documents, corners, NO_ACCURACY));
  const [head = [], ...rows] = parse(measurementsCsv(documents.measurements, project));
  const cell = (row: number, column: string) => rows[row]?.[head.indexOf(column)];
  assert.equal(rows.length, 2);
  assert.equal(cell(0, "name"), "'-wall");
  assert.equal(cell(0, "value"), "5");
  assert.ok(Number(cell(0, "sigma")) > 0);
  assert.equal(cell(0, "unit"), "m");
  assert.equal(cell(0, "coordinates"), "LINESTRING Z (0 0 0, 3 4 0)");
  assert.equal(cell(1, "value"), "12");
  assert.equal(cell(1, "unit"), "m2");
  assert.equal(cell(1, "coordinates"), "POLYGON Z ((0 0 0, 3 4 0, -3 4 0, 0 0 0))");
  assert.equal(cell(1, "crs"), "local metres");
  const placed = parse(measurementsCsv(documents.measurements, sampleProject()));
  assert.match(placed[1]?.[head.indexOf("coordinates")] ?? "", /^LINESTRING Z \(4\d{5}\.\d+ 52\d{5}\.\d+ 408\.25, /);
});

const LOCAL = sampleProject({ georeferenced: false, crs: null });

test("a profile as distance, height and deviation", () => {
  const documents = initialState(sampleProject()).documents;
  const samples = { lengthM: 10, heightsM: [1, null, 3.00004], spreadsM: [0.1, null, null] };
  const profile = newProfile(documents, [samplePoint([0, 0, 0]), samplePoint([10, 0, 0])], samples, LOCAL);
  assert.ok(profile.kind === "profile");
  assert.deepEqual(parse(profileCsv(profile, 400)), [
    ["distance_m", "height_m", "sigma_m"],
    ["0", "401", "0.1"],
    ["5", "", ""],
    ["10", "403", ""],
  ]);
});
