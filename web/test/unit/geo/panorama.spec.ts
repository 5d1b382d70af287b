import assert from "node:assert/strict";
import test from "node:test";
import type { Quat, Vec3 } from "../../../src/base/vec.js";
import { matrixFromQuat } from "../../../src/base/vec_math.js";
import { rotationFromAngles } from "../../../src/geo/camera.js";
import {
  drawDepth,
  drawRows,
  type PanoramaDepth,
  type PanoramaImage,
  type PerspectiveView,
} from "../../../src/geo/panorama.js";

const DEG = Math.PI / 180;

/** Direction through the middle of a pixel, as the export writes panoramas. */
function directionOf(column: number, row: number, width: number, height: number): Vec3 {
  const azimuth = (((column + 0.5) / width) * 360 - 180) * DEG;
  const elevation = (90 - ((row + 0.5) / height) * 180) * DEG;
  return [Math.sin(azimuth) * Math.cos(elevation), Math.cos(azimuth) * Math.cos(elevation), Math.sin(elevation)];
}

/** Its colours are directions: red east, green north, blue up. */
function directions(width: number): PanoramaImage {
  const height = width / 2;
  const rgba = new Uint8ClampedArray(4 * width * height).fill(255);
  for (let row = 0; row < height; row += 1) {
    for (let column = 0; column < width; column += 1) {
      const at = 4 * (row * width + column);
      directionOf(column, row, width, height).forEach((value, k) => {
        rgba[at + k] = 127.5 + 127 * value;
      });
    }
  }
  return { width, height, rgba };
}

function depths(width: number, distance: (direction: Vec3) => number): PanoramaDepth {
  const half: PanoramaDepth = { width: width / 2, height: width / 4, distanceM: new Float32Array((width * width) / 8) };
  for (let j = 0; j < half.height; j += 1) {
    for (let i = 0; i < half.width; i += 1) {
      half.distanceM[j * half.width + i] = distance(directionOf(2 * i, 2 * j, width, width / 2));
    }
  }
  return half;
}

/** Of length 1, ENU. */
function rayOf({ rotation, fovyDeg, width, height }: PerspectiveView, column: number, row: number): Vec3 {
  const focal = height / 2 / Math.tan((fovyDeg / 2) * DEG);
  const ray = [(column + 0.5 - width / 2) / focal, (row + 0.5 - height / 2) / focal, 1];
  const m = matrixFromQuat(rotation);
  const length = Math.hypot(...ray);
  const axis = (k: number) => [0, 1, 2].reduce((sum, i) => sum + (m[3 * i + k] ?? 0) * (ray[i] ?? 0), 0) / length;
  return [axis(0), axis(1), axis(2)];
}

function draw(panorama: PanoramaImage, view: PerspectiveView): Uint8ClampedArray {
  const rgba = new Uint8ClampedArray(4 * view.width * view.height);
  drawRows(panorama, view, rgba, 0, view.height);
  return rgba;
}

/** Largest difference of a colour from its pixel's direction. */
function worst(view: PerspectiveView, rgba: Uint8ClampedArray): number {
  let most = 0;
  for (let row = 0; row < view.height; row += 1) {
    for (let column = 0; column < view.width; column += 1) {
      const at = 4 * (row * view.width + column);
      rayOf(view, column, row).forEach((value, k) => {
        most = Math.max(most, Math.abs((rgba[at + k] ?? 0) - (127.5 + 127 * value)));
      });
      assert.equal(rgba[at + 3], 255);
    }
  }
  return most;
}

const ATTITUDES: readonly [what: string, yawDeg: number, pitchDeg: number, rollDeg: number][] = [
  ["north", 0, 0, 0],
  ["east, a little down", 90, -20, 0],
  ["over the seam in the south", 180, 5, 0],
  ["over the seam, rolled", 179, -10, 37],
  ["straight up", 30, 90, 0],
  ["straight down", 250, -90, 0],
  ["past the upper pole, rolled", 200, 80, 120],
  ["past the lower pole, upside down", 10, -75, 180],
];

test("each pixel shows what lies in its direction", () => {
  const panorama = directions(512);
  for (const [what, yawDeg, pitchDeg, rollDeg] of ATTITUDES) {
    for (const [fovyDeg, width, height] of [
      [50, 64, 36],
      [100, 41, 60],
      [12, 33, 25],
    ] as const) {
      const view = { rotation: rotationFromAngles({ yawDeg, pitchDeg, rollDeg }), fovyDeg, width, height };
      const error = worst(view, draw(panorama, view));
      // Rounding of the panorama and of the picture; a pixel of the panorama is 1.6 of them.
      assert.ok(error <= 1.1, `${what}, ${fovyDeg} degrees: ${error}`);
    }
  }
});

test("a panorama's own pixels come back unchanged", () => {
  const width = 64;
  const rgba = new Uint8ClampedArray(4 * width * (width / 2)).map((_, i) => (i * 2654435761) % 256);
  const panorama = { width, height: width / 2, rgba };
  for (const [column, row] of [
    [0, 0],
    [63, 31],
    [63, 15],
    [0, 16],
    [32, 5],
  ] as const) {
    const [east, north, up] = directionOf(column, row, width, width / 2);
    const rotation = rotationFromAngles({
      yawDeg: Math.atan2(east, north) / DEG,
      pitchDeg: Math.asin(up) / DEG,
      rollDeg: 25,
    });
    const found = draw(panorama, { rotation, fovyDeg: 30, width: 1, height: 1 });
    const at = 4 * (row * width + column);
    assert.deepEqual([...found.slice(0, 3)], [...rgba.slice(at, at + 3)], `pixel ${column}, ${row}`);
  }
});

test("rows can be drawn one after the other", () => {
  const panorama = directions(128);
  const view = {
    rotation: rotationFromAngles({ yawDeg: 77, pitchDeg: -33, rollDeg: 4 }),
    fovyDeg: 60,
    width: 30,
    height: 21,
  };
  const parts = new Uint8ClampedArray(4 * view.width * view.height);
  for (const [from, to] of [
    [14, 21],
    [0, 5],
    [5, 14],
  ] as const) {
    drawRows(panorama, view, parts, from, to);
  }
  assert.deepEqual(parts, draw(panorama, view));
});

test("depth is z along the optical axis, of the nearest direction", () => {
  // A floor 10 m below the eye, and nothing above the horizon.
  const floor = depths(2048, ([, , up]) => (up < 0 ? -10 / up : Number.NaN));
  for (const [what, yawDeg, pitchDeg, rollDeg] of ATTITUDES) {
    const rotation: Quat = rotationFromAngles({ yawDeg, pitchDeg, rollDeg });
    const view = { rotation, fovyDeg: 70, width: 81, height: 50 };
    const { width, height, depthM } = drawDepth(floor, view);
    assert.deepEqual([width, height], [41, 25]);
    const ahead = rayOf({ ...view, width: 1, height: 1 }, 0, 0);
    for (let j = 0; j < height; j += 1) {
      for (let i = 0; i < width; i += 1) {
        const ray = rayOf(view, 2 * i, 2 * j);
        const z = depthM[j * width + i] ?? 0;
        if (ray[2] > 0.01) assert.ok(Number.isNaN(z), `${what}: ${z} in the sky`);
        // Near the horizon the floor is far, and a step of the panorama is long.
        if (ray[2] > -0.2) continue;
        const expected = (-10 / ray[2]) * ray.reduce((sum, value, k) => sum + value * (ahead[k] ?? 0), 0);
        assert.ok(Math.abs(z / expected - 1) < 0.02, `${what}: ${z} for ${expected}`);
      }
    }
  }
});

test("depths of two surfaces are not mixed at their edge", () => {
  const wall = depths(256, ([east]) => (east > 0 ? 5 : 50));
  const view = {
    rotation: rotationFromAngles({ yawDeg: 0, pitchDeg: 0, rollDeg: 10 }),
    fovyDeg: 20,
    width: 200,
    height: 100,
  };
  const { width, depthM } = drawDepth(wall, view);
  depthM.forEach((z, at) => {
    const ray = rayOf(view, 2 * (at % width), 2 * Math.floor(at / width));
    const ahead = rayOf({ ...view, width: 1, height: 1 }, 0, 0);
    const cosine = ray.reduce((sum, value, k) => sum + value * (ahead[k] ?? 0), 0);
    const distance = z / cosine;
    assert.ok(Math.min(Math.abs(distance - 5), Math.abs(distance - 50)) < 1e-3, `${distance}`);
  });
});
