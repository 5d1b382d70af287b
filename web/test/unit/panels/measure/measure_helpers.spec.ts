import assert from "node:assert/strict";
import test from "node:test";
import { deviationNote, measurementText, resultLines } from "../../../../src/panels/measure/measure_text.js";
import { chartScale, linePaths, spreadPaths, ticks } from "../../../../src/panels/measure/profile_scale.js";
import { initialState } from "../../../../src/state/initial.js";
import { newDistance, newPoint, newVolume } from "../../../../src/state/measurements.js";
import { NO_ACCURACY, samplePoint, sampleProject } from "../../state/samples.js";

const FRAME = { w: 300, h: 170, left: 40, right: 10, top: 10, bottom: 30 };

test("ticks are round, inside, and few", () => {
  assert.deepEqual(ticks(0, 87, 6), [0, 20, 40, 60, 80]);
  assert.deepEqual(ticks(0.1, 0.75, 4), [0.2, 0.4, 0.6]);
  assert.deepEqual(ticks(-3, 3, 3), [-2, 0, 2]);
  assert.deepEqual(ticks(408.27, 408.47, 4), [408.3, 408.35, 408.4, 408.45]);
  for (const [low, high] of [
    [5, 5],
    [5, 4],
    [0, Number.NaN],
    [0, Number.POSITIVE_INFINITY],
  ] as const) {
    assert.deepEqual(ticks(low, high, 4), []);
  }
});

test("the chart holds all heights, gaps stay gaps, and a flat profile stays flat", () => {
  const profile = { lengthM: 20, heightsM: [1, 2, null, 4, 3], spreadsM: [0.1, 0.2, null, null, 0.1] };
  const scale = chartScale(profile, 400, FRAME);
  assert.ok(scale !== null);
  assert.equal(scale.x(0), 40);
  assert.equal(scale.x(20), 290);
  assert.equal(scale.xOf(4), 290);
  assert.equal(scale.indexAt(scale.xOf(3)), 3);
  assert.ok(scale.lowM < 401 && scale.highM > 404);
  assert.ok(scale.y(404) < scale.y(401) && scale.y(404) >= 10 && scale.y(401) <= 140);
  assert.equal(linePaths(profile.heightsM, 400, scale).length, 2);
  assert.equal(spreadPaths(profile.heightsM, profile.spreadsM, 400, scale).length, 1);
  const flat = chartScale({ lengthM: 0, heightsM: [5, 5], spreadsM: [] }, 0, FRAME);
  assert.ok(flat !== null && flat.highM - flat.lowM >= 0.199 && Number.isFinite(flat.x(0)));
  assert.equal(chartScale({ lengthM: 9, heightsM: [null, null], spreadsM: [] }, 0, FRAME), null);
  assert.equal(chartScale({ lengthM: 9, heightsM: [], spreadsM: [] }, 0, FRAME), null);
});

test("results say ± and what it lacks", () => {
  const { documents } = initialState(sampleProject());
  const project = sampleProject();
  const sure = newDistance(documents, [samplePoint([0, 0, 0]), samplePoint([3, 4, 0])], project);
  assert.match(resultLines(sure, project)[0]?.text ?? "", /^5\.\d+ m ± 0\.\d+ m$/);
  assert.equal(deviationNote(sure, project), "");
  assert.match(measurementText(sure, project), /^Distance 1\nDistance: 5/);
  assert.match(deviationNote(sure, sampleProject({ accuracy: NO_ACCURACY })), /without the geo-reference's share/);
  const mesh = newDistance(documents, [samplePoint([0, 0, 0], null), samplePoint([3, 4, 0])], project);
  assert.equal(resultLines(mesh, project)[0]?.text, "5.00 m");
  assert.match(deviationNote(mesh, project), /not all points are confirmed/);
});

test("points are given in the survey's coordinates, heights of bases too", () => {
  const { documents } = initialState(sampleProject());
  const project = sampleProject();
  const point = newPoint(documents, [samplePoint([0, 0, 2])]);
  const texts = resultLines(point, project).map(({ label, text }) => `${label}: ${text}`);
  assert.match(texts.join("\n"), /Easting, northing: 4\d+\.\d\d E, 52\d+\.\d\d N/);
  assert.match(texts.join("\n"), /Height: 410\.25 m ± 2\.00 m/);
  const local = sampleProject({ georeferenced: false, crs: null, accuracy: NO_ACCURACY });
  assert.match(
    resultLines(point, local)
      .map(({ text }) => text)
      .join("\n"),
    /^0\.000, 0\.000\n2\.00 m/,
  );
  const result = { cut: 1, fill: 2, net: { value: -1, sigma: 0.1 }, surfaceArea: 5, filled: 1, cellM: 0.1 };
  const volume = newVolume(
    documents,
    [0, 1, 2].map((i) => samplePoint([i, i * i, 0])),
    "height",
    10,
    result,
  );
  assert.equal(resultLines(volume, project).find(({ label }) => label === "Base")?.text, "level at 418.25 m");
  assert.equal(deviationNote(volume, project), "");
  const accuracy = { ...project.accuracy, verticalM: null };
  assert.match(deviationNote(volume, sampleProject({ accuracy })), /without the vertical accuracy/);
});
