import assert from "node:assert/strict";
import { test } from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { norm, sub } from "../../../src/base/vec_math.js";
import { mapFromEnu } from "../../../src/geo/projection.js";
import { boxEdges, frustumDepthM, frustumEdges } from "../../../src/scene/line_shapes.js";
import { clipLine } from "../../../src/scene/overlay_clip.js";
import { overlayInputs, overlayItems } from "../../../src/scene/overlay_items.js";
import type { AppState, SurfacePoint } from "../../../src/state/app_state.js";
import { initialState } from "../../../src/state/initial.js";
import type { Photo, PhotoCamera } from "../../../src/state/project.js";
import { sampleBuilding, sampleSet } from "../state/building_samples.js";
import { lookingAt, sampleProject } from "./samples.js";

const PROJECT = sampleProject({
  blocks: [{ name: "r0c0", min: [0, 0, 0], max: [10, 20, 5], empty: false, photos: 3, psnrDb: null }],
});

function at(enu: Vec3): SurfacePoint {
  return { enu, direction: [0, 0, -1], spreadM: 0.01, pixelM: 0.1, source: "mesh" };
}

function state(patch: Partial<AppState>): AppState {
  return { ...initialState(PROJECT), ...patch };
}

test("lines are cut at the plane before the eye, on both ends", () => {
  const parts = clipLine(
    [
      [0, 0, -2],
      [0, 0, 2],
      [4, 0, 2],
      [4, 0, -2],
      [8, 0, -2],
      [8, 0, 5],
    ],
    false,
    1,
  );
  assert.deepEqual(parts, [
    [
      [0, 0, 1],
      [0, 0, 2],
      [4, 0, 2],
      [4, 0, 1],
    ],
    [
      [8, 0, 1],
      [8, 0, 5],
    ],
  ]);
  assert.deepEqual(
    clipLine(
      [
        [0, 0, -1],
        [1, 0, -2],
      ],
      false,
      1,
    ),
    [],
  );
  assert.deepEqual(clipLine([[0, 0, 3]], false, 1), []);
});

test("an area that reaches behind the camera keeps the part ahead", () => {
  const [area] = clipLine(
    [
      [0, 0, 3],
      [2, 0, 3],
      [2, 0, -1],
      [0, 0, -1],
    ],
    true,
    1,
  );
  assert.ok(area !== undefined && area.length === 4);
  assert.ok(area.every((p) => p[2] >= 1 - 1e-12));
  assert.deepEqual(
    clipLine(
      [
        [0, 0, -3],
        [2, 0, -3],
        [2, 0, -1],
      ],
      true,
      1,
    ),
    [],
  );
});

test("each measurement has its line, its points and a text with +-", () => {
  const documents = {
    ...initialState(PROJECT).documents,
    measurements: [
      {
        id: "a",
        kind: "distance" as const,
        name: "Ridge",
        points: [at([0, 0, 0]), at([10, 0, 0]), at([10, 10, 0])],
        result: {
          slope: { value: 20, sigma: 0.05 },
          plan: { value: 20, sigma: 0.05 },
          rise: { value: 0, sigma: 0.05 },
        },
      },
    ],
  };
  const items = overlayItems(PROJECT, state({ documents, selected: "a" }), 100);
  assert.equal(items.filter((item) => item.kind === "dot").length, 3);
  const label = items.find((item) => item.kind === "label");
  assert.ok(label?.kind === "label" && /^Ridge: 20\.00 m ± 0\.05 m$/.test(label.text), JSON.stringify(label));
  // Half way along the line, which is its corner.
  assert.deepEqual(label.point, [10, 0, 0]);
  assert.ok(items.every((item) => item.style === "selected"));
  const hidden = state({ documents, layers: { ...initialState(PROJECT).layers, measurements: false } });
  assert.deepEqual(overlayItems(PROJECT, hidden, 100), []);
});

test("the draft follows the pointer and says how long or large it is", () => {
  const draft = [at([0, 0, 0]), at([10, 0, 0])];
  const line = overlayItems(PROJECT, state({ tool: "distance", draft, hover: at([10, 5, 0]) }), 100);
  assert.ok(line.some((item) => item.kind === "label" && item.text === "15.00 m"));
  const area = overlayItems(PROJECT, state({ tool: "area", draft, hover: at([10, 6, 0]) }), 100);
  assert.ok(area.some((item) => item.kind === "label" && item.text === "30.0 m²"));
  assert.ok(area.some((item) => item.kind === "line" && item.closed));
  assert.deepEqual(overlayItems(PROJECT, state({ tool: "navigate", draft, hover: at([1, 1, 1]) }), 100), []);
});

test("control points stand at their map coordinates, or at local metres", () => {
  const enu: Vec3 = [12, -30, 4];
  const xyz = mapFromEnu(PROJECT, enu);
  assert.ok(xyz !== null);
  const documents = { ...initialState(PROJECT).documents, controlPoints: [{ name: "P1", xyz, marks: [] }] };
  const [cross] = overlayItems(PROJECT, state({ documents }), 100);
  assert.ok(cross?.kind === "cross" && norm(sub(cross.point, enu)) < 1e-3);
  const local = sampleProject({ georeferenced: false, crs: null });
  const [there] = overlayItems(local, { ...state({ documents }) }, 100);
  assert.ok(there?.kind === "cross" && there.point === xyz);
});

test("blocks have names, key frames a place and a direction", () => {
  const pose = lookingAt([0, 0, 10], [0, 10, 10]);
  const documents = { ...initialState(PROJECT).documents, cameraPath: { keys: [{ name: "", pose }], speedMps: 5 } };
  const items = overlayItems(
    PROJECT,
    state({ documents, layers: { ...initialState(PROJECT).layers, blocks: true } }),
    400,
  );
  assert.ok(items.some((item) => item.kind === "label" && item.text === "r0c0" && item.point[2] === 5));
  const line = items.find((item) => item.kind === "line");
  assert.ok(line?.kind === "line" && norm(sub(line.points[1] ?? [0, 0, 0], [0, 10, 10])) < 1e-9);
  assert.ok(items.some((item) => item.kind === "label" && item.text === "1"));
});

test("what the marks depend on is among their inputs", () => {
  const before = state({});
  for (const patch of [
    { draft: [at([0, 0, 0])] },
    { hover: at([0, 0, 0]) },
    { tool: "area" as const },
    { selected: "x" },
  ]) {
    assert.notDeepEqual(overlayInputs({ ...before, ...patch }), overlayInputs(before));
  }
  assert.ok(
    overlayInputs({ ...before, readout: { ...before.readout, fps: 3 } }).every((value, i) =>
      Object.is(value, overlayInputs(before)[i]),
    ),
  );
});

test("a box has twelve different edges along its axes", () => {
  const edges = boxEdges({ min: [0, 0, 0], max: [1, 2, 3] }, [10, 0, 0]);
  assert.equal(edges.length, 72);
  const seen = new Set<string>();
  for (let i = 0; i < 72; i += 6) {
    const [a, b] = [edges.slice(i, i + 3), edges.slice(i + 3, i + 6)];
    assert.equal(a.filter((value, k) => value !== b[k]).length, 1);
    seen.add([a.join(), b.join()].sort().join(" "));
  }
  assert.equal(seen.size, 12);
  assert.equal(Math.min(...edges), -10);
});

test("a camera's pyramid looks where the photo looks, with its field of view", () => {
  const camera: PhotoCamera = { model: "SIMPLE_RADIAL", width: 640, height: 360, params: [320, 320, 180, 0] };
  const pose = lookingAt([0, 0, 50], [0, 100, 50]);
  const photo: Photo = {
    index: 0,
    name: "a",
    camera: 0,
    position: [0, 0, 50],
    rotation: pose.rotation,
    isTest: false,
    psnrDb: null,
    available: true,
  };
  const edges = frustumEdges(photo, camera, 10, [0, 0, 0]);
  // First edge: from the place to the upper left corner, 10 m ahead, 10 to the left, 5.6 up.
  assert.ok(
    norm(sub([edges[3] ?? 0, edges[4] ?? 0, edges[5] ?? 0], [-10, 10, 50 + 5.625])) < 1e-9,
    edges.slice(0, 6).join(),
  );
  assert.deepEqual(frustumEdges({ ...photo, position: [Number.NaN, 0, 0] }, camera, 10, [0, 0, 0]), []);
  assert.ok(frustumDepthM([], 100) > 0);
});

test("the chosen building and the one under the pointer have their height above them", () => {
  const high = sampleBuilding(7);
  const measures = { ...high.measures, height: { value: 7.2957, sigma: 0.3479 } };
  const set = sampleSet([sampleBuilding(3), { ...high, measures }]);
  const on = { ...initialState(PROJECT).layers, buildings: true };
  const buildings = { set, loading: false, error: "" };
  const chosen: Partial<AppState> = { layers: on, buildings, selectedBuilding: 7 };
  const items = (patch: Partial<AppState>) => overlayItems(PROJECT, state({ ...chosen, ...patch }), 100);
  const point = [5, 3, 4];
  const label = { kind: "label", style: "selected", point, text: "Building 7: 7.3 m ± 0.3 m" };
  assert.deepEqual(items({}), [label]);
  assert.deepEqual(items({ hoverBuilding: 7 }), [label], "once");
  assert.deepEqual(items({ hoverBuilding: 3 }), [
    label,
    { kind: "label", style: "building", point, text: "Building 3" },
  ]);
  const bare = { ...buildings, set: { ...set, metric: false } };
  assert.deepEqual(items({ buildings: bare }), [{ ...label, text: "Building 7: 7.3 ± 0.3" }]);
  assert.deepEqual(items({ selectedBuilding: 99 }), []);
  assert.deepEqual(items({ layers: { ...on, buildings: false } }), []);
  const clip = { on: true, min: [20, 0, 0], max: [40, 40, 40] } as const;
  assert.deepEqual(items({ clip }), [], "what is clipped away has no label");
});
