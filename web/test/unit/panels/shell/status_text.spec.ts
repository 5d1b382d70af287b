import assert from "node:assert/strict";
import test from "node:test";
import { cursorText, engineText } from "../../../../src/panels/shell/status_text.js";
import type { EngineStatus, SurfacePoint } from "../../../../src/state/app_state.js";

const point: SurfacePoint = { enu: [0, 0, 4.2], direction: [0, 0, -1], spreadM: 0.034, pixelM: 0.05, source: "field" };
const origin = { latitudeDeg: 47.3769, longitudeDeg: 8.5417, heightM: 408 };

test("coordinates under the cursor in the survey's system", () => {
  const project = { georeferenced: true, crs: { name: "EPSG:32632", zone: 32, north: true }, origin };
  const text = cursorText(project, point);
  assert.equal(text.height, "H 412.20 m");
  assert.match(text.first, /^E 46540\d\.\d\d$/);
  assert.match(text.second, /^N 524715\d\.\d\d$/);
  assert.equal(text.latLon, "47.3769000° N, 8.5417000° E");
  assert.equal(text.source, "field ± 3.4 cm");
});

test("coordinates without geo-reference are those of the project", () => {
  const text = cursorText({ georeferenced: false, crs: null, origin }, { ...point, source: "mesh", spreadM: null });
  assert.deepEqual(text, { first: "x 0.00", second: "y 0.00", height: "z 4.20 m", latLon: "", source: "mesh" });
});

test("the engine's state in words", () => {
  const engine: EngineStatus = {
    connected: true,
    ready: true,
    reason: "",
    revision: 1,
    exposure: "normal",
    clients: 1,
    ranks: 1,
    pass: -1,
    passes: 3,
  };
  const layers = {
    surface: true,
    exact: true,
    buildings: false,
    blocks: false,
    cameras: false,
    points: false,
    contours: false,
    errorMap: false,
    trust: false,
    measurements: true,
    controlPoints: true,
    cameraPath: true,
    things: true,
  };
  const kind = (change: Partial<EngineStatus>) => engineText({ ...engine, ...change }, layers).kind;
  assert.equal(kind({ connected: false }), "lost");
  assert.equal(kind({ ready: false, reason: "in training" }), "off");
  assert.equal(kind({}), "waiting");
  assert.equal(kind({ pass: 1 }), "working");
  assert.equal(kind({ pass: 2 }), "exact");
  assert.equal(engineText({ ...engine, pass: 2 }, { ...layers, exact: false }).kind, "off");
});
