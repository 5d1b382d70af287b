import assert from "node:assert/strict";
import test from "node:test";
import { initialState } from "../../../src/state/initial.js";
import { sampleProject } from "./samples.js";

test("a project without mesh and maps opens with its points and cameras", () => {
  const project = { ...sampleProject(), tiles: null, terrain: null };
  assert.equal(initialState(project).layers.points, true);
  assert.equal(initialState(project).layers.cameras, true);
  const mapped = { ...project, terrain: "/data/terrain.bin" };
  assert.equal(initialState(mapped).layers.points, false);
  assert.equal(initialState(mapped).layers.cameras, false);
});
