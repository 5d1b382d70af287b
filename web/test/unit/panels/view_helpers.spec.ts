import assert from "node:assert/strict";
import test from "node:test";
import { anglesOfPose, forward, rotationFromAngles } from "../../../src/geo/camera.js";
import { cursorText, engineText, shortVertical } from "../../../src/panels/shell/status_text.js";
import { northUp } from "../../../src/panels/shell/turn_north.js";
import { psnrQuality, rampColour } from "../../../src/panels/widgets/ramp.js";
import { stepOfKey } from "../../../src/panels/widgets/slider_keys.js";
import type { EngineStatus, SurfacePoint } from "../../../src/state/app_state.js";
import { boxAround, withFace } from "../../../src/state/clip_box.js";
import { photoFovyDeg } from "../../../src/state/photo_pose.js";

test("faces of the clip box do not pass each other", () => {
  const box = { on: true, min: [0, 0, 0], max: [10, 10, 10] } as const;
  assert.deepEqual(withFace(box, "min", 0, 4).min, [4, 0, 0]);
  assert.deepEqual(withFace(box, "min", 1, 50).min, [0, 9.9, 0]);
  assert.deepEqual(withFace(box, "max", 2, -50).max, [10, 10, 0.1]);
  assert.equal(withFace(box, "max", 2, Number.NaN), box);
});

test("a box around points leaves out what is not finite", () => {
  assert.equal(boxAround([[Number.NaN, 0, 0]], 1), null);
  assert.deepEqual(
    boxAround(
      [
        [0, 5, 2],
        [3, -1, 2],
        [Number.NaN, 0, 0],
      ],
      1,
    ),
    { min: [-1, -2, 1], max: [4, 6, 3] },
  );
});

test("north up turns about the place that is looked at and keeps tilt and distance", () => {
  const rotation = rotationFromAngles({ yawDeg: 125, pitchDeg: -40, rollDeg: 0 });
  const ahead = forward(rotation);
  const target = [30, -7, 2] as const;
  const eye = [target[0] - 50 * ahead[0], target[1] - 50 * ahead[1], target[2] - 50 * ahead[2]] as const;
  const turned = northUp({ eyeEnu: eye, rotation, fovyDeg: 50, orthoHeightM: null }, target);
  const { yawDeg, pitchDeg } = anglesOfPose(turned.rotation);
  assert.ok(Math.min(yawDeg, 360 - yawDeg) < 1e-9 && Math.abs(pitchDeg + 40) < 1e-9);
  const now = forward(turned.rotation);
  for (const axis of [0, 1, 2] as const) {
    assert.ok(Math.abs(turned.eyeEnu[axis] + 50 * now[axis] - target[axis]) < 1e-9);
  }
  assert.deepEqual(northUp({ eyeEnu: eye, rotation, fovyDeg: 50, orthoHeightM: null }, null).eyeEnu, eye);
});

test("field of view of a photo by its camera model", () => {
  const camera = (model: string, params: number[]) => ({ model, width: 400, height: 200, params });
  const right = (deg: number, expected: number) => assert.ok(Math.abs(deg - expected) < 1e-9, `${deg}`);
  right(photoFovyDeg(camera("SIMPLE_RADIAL", [100, 200, 100, 0])), 90);
  right(photoFovyDeg(camera("OPENCV", [500, 100, 200, 100, 0, 0, 0, 0])), 90);
  right(photoFovyDeg(camera("OPENCV_FISHEYE", [500, 200, 200, 100, 0, 0, 0, 0])), 180 / Math.PI);
  right(photoFovyDeg(camera("RADIAL_FISHEYE", [200, 200, 100, 0, 0])), 180 / Math.PI);
  // atan(2 r tan(omega / 2)) / omega is half the height over the focal length where r = 1.
  const edge = Math.atan(2 * Math.tan(0.45)) / 0.9;
  right(photoFovyDeg(camera("FOV", [500, 100 / edge, 200, 100, 0.9])), 90);
  right(photoFovyDeg(camera("FOV", [500, 100, 200, 100, 0])), 90);
  assert.ok(photoFovyDeg(camera("PINHOLE", [])) > 0);
});

test("the ramp begins and ends like viridis and is clamped", () => {
  assert.equal(rampColour(0), "rgb(68 1 84)");
  assert.equal(rampColour(7), "rgb(253 231 37)");
  assert.equal(rampColour(Number.NaN), rampColour(0));
  assert.equal(rampColour(1 / 16), "rgb(70 21 102)");
  assert.equal(psnrQuality(27.5), 0.5);
});

test("keys of a slider", () => {
  assert.equal(stepOfKey("ArrowRight", false, 0.5), 0.51);
  assert.equal(stepOfKey("ArrowLeft", true, 0.05), 0);
  assert.equal(stepOfKey("End", false, 0.2), 1);
  assert.equal(stepOfKey("Tab", false, 0.2), null);
});

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

test("the datum in short", () => {
  assert.equal(shortVertical("heights above the WGS84 ellipsoid"), "WGS84 ellipsoid");
  assert.equal(shortVertical("local metres"), "local metres");
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
