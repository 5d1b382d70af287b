import assert from "node:assert/strict";
import { test } from "node:test";
import { parseContours, parsePoints } from "../../../src/scene/points_file.js";
import {
  makePatch,
  parseTerrain,
  patchesOf,
  shade,
  stepFor,
  type TerrainGrid,
} from "../../../src/scene/terrain_grid.js";
import { sampleBase } from "./samples.js";

function terrainBytes(columns: number, rows: number, z: (column: number, row: number) => number): ArrayBuffer {
  const bytes = new ArrayBuffer(40 + 12 * columns * rows);
  new Uint8Array(bytes).set(new TextEncoder().encode("SKYTERR1"));
  const view = new DataView(bytes);
  view.setUint32(8, columns, true);
  view.setUint32(12, rows, true);
  for (const [i, value] of [100, 200, 5].entries()) view.setFloat64(16 + 8 * i, value, true);
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      const at = 40 + 12 * (row * columns + column);
      view.setFloat32(at, column, true);
      // The first row is the north.
      view.setFloat32(at + 4, -row, true);
      view.setFloat32(at + 8, z(column, row), true);
    }
  }
  return bytes;
}

function everything(grid: TerrainGrid, step: number) {
  return patchesOf(grid, step, 8).flatMap(({ from, to }) => makePatch(grid, from, to, step) ?? []);
}

test("a surface model is read with its anchor; its triangles face up", () => {
  const grid = parseTerrain(terrainBytes(5, 4, (column) => column));
  assert.deepEqual([grid.columns, grid.rows, ...grid.anchor], [5, 4, 100, 200, 5]);
  const patch = makePatch(grid, [0, 0], [4, 3], 1);
  assert.ok(patch !== null);
  assert.equal(patch.indices.length, 6 * 4 * 3);
  for (let i = 2; i < patch.normals.length; i += 3) assert.ok((patch.normals[i] ?? 0) > 0);
  assert.deepEqual([...patch.uvs.slice(-2)], [1, 1]);
  const grey = shade(patch.normals);
  assert.ok(grey.every((value) => value >= 0 && value <= 1));
});

test("damaged surface models are refused with a reason", () => {
  const good = terrainBytes(5, 4, () => 0);
  assert.throws(() => parseTerrain(new ArrayBuffer(0)), /damaged/);
  assert.throws(() => parseTerrain(good.slice(0, good.byteLength - 1)), /damaged/);
  const huge = good.slice(0);
  new DataView(huge).setUint32(8, 0xffffffff, true);
  assert.throws(() => parseTerrain(huge), /damaged/);
});

test("where heights are missing there are holes, not spikes", () => {
  const grid = parseTerrain(terrainBytes(9, 9, (column, row) => (column === 4 && row === 4 ? Number.NaN : 1)));
  const patch = makePatch(grid, [0, 0], [8, 8], 1);
  assert.ok(patch !== null);
  // Six of the eight triangles around a point: of two cells one triangle without it stays.
  assert.ok(patch.indices.length / 3 >= 2 * 64 - 8 && patch.indices.length / 3 < 2 * 64);
  assert.ok(!patch.indices.includes(4 * 9 + 4));
  assert.ok(patch.positions.every(Number.isFinite));
  assert.equal(makePatch(parseTerrain(terrainBytes(3, 3, () => Number.NaN)), [0, 0], [2, 2], 1), null);
});

test("parts meet without gaps at every step", () => {
  const grid = parseTerrain(terrainBytes(38, 27, (column, row) => Math.sin(column) + Math.cos(row)));
  for (const step of [1, 2, 3]) {
    const area = everything(grid, step).reduce((sum, patch) => {
      let part = 0;
      for (let i = 0; i < patch.indices.length; i += 3) {
        const at = (k: number, axis: number) => patch.positions[3 * (patch.indices[i + k] ?? 0) + axis] ?? 0;
        part += ((at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) - (at(2, 0) - at(0, 0)) * (at(1, 1) - at(0, 1))) / 2;
      }
      return sum + part;
    }, 0);
    assert.ok(Math.abs(area - 37 * 26) < 1e-3, `step ${step}: ${area}`);
  }
  assert.equal(stepFor(grid, 1e6), 1);
  const step = stepFor(grid, 300);
  assert.ok(2 * Math.ceil(37 / step) * Math.ceil(26 / step) <= 300);
});

test("points are read, and refused when they do not fit", () => {
  const bytes = new ArrayBuffer(40 + 15 * 2);
  new Uint8Array(bytes).set(new TextEncoder().encode("SKYPNTS1"));
  const view = new DataView(bytes);
  view.setUint32(8, 2, true);
  for (const [i, value] of [1, 2, 3].entries()) view.setFloat64(16 + 8 * i, value, true);
  for (const [i, value] of [0.5, 1.5, 2.5, 3.5, 4.5, 5.5].entries()) view.setFloat32(40 + 4 * i, value, true);
  for (const [i, value] of [10, 20, 30, 40, 50, 60].entries()) view.setUint8(64 + i, value);
  const points = parsePoints(bytes);
  assert.deepEqual([...points.positions], [0.5, 1.5, 2.5, 3.5, 4.5, 5.5]);
  assert.deepEqual([...points.colours], [10, 20, 30, 40, 50, 60]);
  assert.throws(() => parsePoints(bytes.slice(0, 60)), /damaged/);
  assert.throws(() => parsePoints(new ArrayBuffer(3)), /damaged/);
});

test("contours get the height of ENU, from which the Earth curves away", () => {
  const json = {
    interval_m: 1,
    lines: [
      { height_m: 420, index: 1, points: [0, 0, 2000, 0, 2000, 1000] },
      { height_m: 409, index: 0, points: [5, 5] },
    ],
  };
  const { plain, index } = parseContours(json, sampleBase(), [0, 0, 10]);
  assert.equal(plain.length, 0);
  assert.equal(index.length, 2 * 6);
  assert.ok(Math.abs((index[2] ?? 0) - 2) < 1e-6);
  assert.ok(Math.abs((index[5] ?? 0) - (2 - 2000 ** 2 / (2 * 6371000))) < 1e-4);
  assert.throws(
    () => parseContours({ lines: [{ height_m: "x", index: 0, points: [] }] }, sampleBase(), [0, 0, 0]),
    /contours\.lines\[0\]\.height_m/,
  );
  assert.throws(() => parseContours(null, sampleBase(), [0, 0, 0]));
});
