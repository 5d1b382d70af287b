import assert from "node:assert/strict";
import test from "node:test";
import type { Vec3 } from "../../../src/base/vec.js";
import { makePatch } from "../../../src/scene/terrain_grid.js";
import { Heights, NOTHING } from "../../../src/tour/heights.js";
import { heightsFromTerrain, type TerrainPoints } from "../../../src/tour/terrain_heights.js";
import { distanceToSolid, random, randomTerrain, terrainOf } from "./terrains.js";

test("at the lowest free height a sphere touches the solid, below it it is cut, above it is free", () => {
  for (let seed = 1; seed <= 12; seed += 1) {
    const { cells, heights } = randomTerrain(seed);
    const next = random(1000 + seed);
    for (let i = 0; i < 100; i += 1) {
      const radius = 0.5 + 2 * next();
      const x = cells.min[0] + cells.columns * cells.cellM[0] * (1.2 * next() - 0.1);
      const y = cells.min[1] + cells.rows * cells.cellM[1] * (1.2 * next() - 0.1);
      const z = heights.dilated(x, y, radius);
      const far = (up: number) => distanceToSolid(cells, [x, y, up], 4);
      if (z === NOTHING) {
        assert.ok(far(-1e6) >= radius, `seed ${seed}`);
        continue;
      }
      assert.ok(far(z) >= radius - 1e-9 && far(z + 5 * next()) >= radius - 1e-9, `seed ${seed}`);
      assert.ok(far(z - 1e-6) < radius, `seed ${seed}`);
    }
  }
});

test("slack holds for every place within it, and is no more than a larger radius", () => {
  for (let seed = 1; seed <= 8; seed += 1) {
    const { cells, heights } = randomTerrain(seed);
    const next = random(seed);
    for (let i = 0; i < 100; i += 1) {
      const x = cells.min[0] + cells.columns * cells.cellM[0] * next();
      const y = cells.min[1] + cells.rows * cells.cellM[1] * next();
      const slack = 2 * next();
      const z = heights.dilated(x, y, 1, slack);
      for (let k = 0; k < 20; k += 1) {
        const [angle, away] = [2 * Math.PI * next(), slack * next()];
        const there = heights.dilated(x + away * Math.cos(angle), y + away * Math.sin(angle), 1);
        assert.ok(there <= z + 1e-9, `seed ${seed}`);
      }
      assert.ok(z <= heights.highest(x, y, 1 + slack) + 1);
    }
  }
});

test("a tower counts up to its walls and no farther", () => {
  const { heights } = terrainOf(9, 9, (column, row) => (column === 4 && row === 4 ? 20 : 0));
  assert.equal(heights.at(4.5, 4.5), 20);
  assert.equal(heights.at(3.99, 4.5), 0);
  assert.equal(heights.at(9.5, 4.5), null);
  assert.equal(heights.dilated(4.5, 4.5, 1), 21);
  assert.equal(heights.dilated(3.5, 4.5, 1), 20 + Math.sqrt(0.75));
  assert.equal(heights.dilated(3, 4.5, 1), 1);
  assert.equal(heights.highest(3, 4.5, 1), 0);
  assert.equal(heights.highest(3.1, 4.5, 1), 20);
  // By the corner, over two axes.
  assert.equal(heights.dilated(3.5, 3.5, 1), 20 + Math.sqrt(0.5));
});

test("without surface there is nothing to keep away from", () => {
  const none = terrainOf(3, 3, () => Number.NaN).heights;
  assert.deepEqual([none.at(1, 1), none.dilated(1, 1, 1), none.highest(1, 1, 9)], [null, NOTHING, NOTHING]);
  const one = terrainOf(1, 1, () => 5).heights;
  assert.deepEqual([one.at(0.5, 0.5), one.dilated(0.5, 0.5, 1), one.dilated(3, 0.5, 1)], [5, 6, NOTHING]);
  for (const x of [1e9, -1e9, Number.NaN]) assert.equal(one.dilated(x, 0, 1), NOTHING);
  assert.throws(() => new Heights({ min: [0, 0], cellM: [1, 1], columns: 2, rows: 2, z: new Float64Array(3) }), /fit/);
  assert.throws(() => new Heights({ min: [0, 0], cellM: [1, 0], columns: 1, rows: 1, z: new Float64Array(1) }), /size/);
});

/** Like terrain.bin: turned against ENU, from the north-west. */
function terrainPoints(
  columns: number,
  rows: number,
  turnedDeg: number,
  z: (column: number, row: number) => number,
): TerrainPoints {
  const turn = (turnedDeg * Math.PI) / 180;
  const [c, s] = [0.8 * Math.cos(turn), 0.8 * Math.sin(turn)];
  const points = new Float32Array(3 * columns * rows);
  for (let i = 0; i < columns * rows; i += 1) {
    const [column, row] = [i % columns, Math.floor(i / columns)];
    const height = z(column, row);
    const point = [column * c + row * s, column * s - row * c, height];
    points.set(Number.isNaN(height) ? [Number.NaN, Number.NaN, Number.NaN] : point, 3 * i);
  }
  return { columns, rows, anchor: [1000, 2000, 300], points };
}

test("the columns hold the surface that is drawn from the same points", () => {
  for (const turnedDeg of [0, 1.3, -2, 30, 90, 180]) {
    const next = random(turnedDeg + 500);
    const terrain = terrainPoints(17, 13, turnedDeg, () => (next() < 0.1 ? Number.NaN : 20 * next()));
    const heights = heightsFromTerrain(terrain);
    const patch = makePatch(terrain, [0, 0], [16, 12], 1);
    assert.ok(heights !== null && patch !== null);
    const corner = (i: number): Vec3 => {
      const at = 3 * (patch.indices[i] ?? 0);
      const point = [0, 1, 2].map((axis) => (patch.positions[at + axis] ?? 0) + (terrain.anchor[axis] ?? 0));
      return [point[0] ?? 0, point[1] ?? 0, point[2] ?? 0];
    };
    for (let i = 0; i < patch.indices.length; i += 3) {
      const [a, b, c] = [corner(i), corner(i + 1), corner(i + 2)];
      for (let k = 0; k < 10; k += 1) {
        // Not at the very edges, which are rounded to floats.
        const [u, v] = [0.01 + 0.97 * next(), 0.01 + 0.97 * next()];
        const [p, q] = u + v < 0.99 ? [u, v] : [0.99 - u > 0 ? 0.99 - u : 0.01, 0.005];
        const at = (axis: 0 | 1 | 2) => a[axis] + p * (b[axis] - a[axis]) + q * (c[axis] - a[axis]);
        const top = heights.at(at(0), at(1));
        assert.ok(top !== null && top >= at(2) - 1e-4, `turned ${turnedDeg}: ${top} at ${at(2)}`);
      }
    }
  }
});

test("a grid that is not turned makes a wall a cell thicker to each side, not more", () => {
  const terrain = terrainPoints(20, 10, 0, (column) => (column === 10 ? 15 : 0));
  const heights = heightsFromTerrain(terrain);
  assert.ok(heights);
  const [x, y] = [1000 + 0.8 * 10, 2000 - 0.8 * 5];
  for (const away of [0.79, -0.79]) assert.equal(heights.at(x + away, y), 315);
  for (const away of [0.81, -0.81]) assert.equal(heights.at(x + away, y), 300);
  // As far as a cell beyond the outermost points, and nothing outside.
  assert.equal(heights.at(1000 - 0.79, 2000 + 0.79), 300);
  assert.equal(heights.at(1000 - 0.81, 2000), null);
});

test("few points make what they can", () => {
  const only = (there: (column: number, row: number) => boolean) =>
    heightsFromTerrain(terrainPoints(6, 6, 10, (column, row) => (there(column, row) ? 7 : Number.NaN)));
  assert.equal(
    only(() => false),
    null,
  );
  assert.equal(only((column, row) => column === 0 && row === 0)?.at(1000.5, 1999.5), 307);
  assert.equal(only((column) => column === 0)?.at(1000, 2000), 307);
  assert.equal(only((_, row) => row === 0)?.at(1000, 2000), 307);
  assert.equal(only((column, row) => column === row)?.at(1000, 2000), 307);
  const same: TerrainPoints = { columns: 2, rows: 2, anchor: [0, 0, 0], points: new Float32Array(12) };
  assert.throws(() => heightsFromTerrain(same), /not a grid/);
  const far = terrainPoints(6, 6, 0, () => 0);
  far.points.set([1e7, 0, 0], 0);
  assert.throws(() => heightsFromTerrain(far), /not a grid/);
});
