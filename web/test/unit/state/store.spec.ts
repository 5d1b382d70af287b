import assert from "node:assert/strict";
import test from "node:test";
import type { Documents } from "../../../src/state/app_state.js";
import { initialState } from "../../../src/state/initial.js";
import {
  newDistance,
  newPoint,
  replacePoint,
  withMeasurement,
  withoutMeasurement,
} from "../../../src/state/measurements.js";
import { Store } from "../../../src/state/store.js";
import { NO_ACCURACY, samplePoint, sampleProject } from "./samples.js";

const PROJECT = sampleProject({ accuracy: NO_ACCURACY });

function newStore(): Store {
  return new Store(initialState(sampleProject()));
}

function addDistance(store: Store, points: readonly ReturnType<typeof samplePoint>[]): void {
  store.changeDocuments("add distance", (documents) =>
    withMeasurement(documents, newDistance(documents, points, PROJECT)),
  );
}

test("undo and redo go through the steps; what is new ends redo", () => {
  const store = newStore();
  addDistance(store, [samplePoint([0, 0, 0]), samplePoint([1, 0, 0])]);
  addDistance(store, [samplePoint([0, 0, 0]), samplePoint([2, 0, 0])]);
  assert.deepEqual(
    store.get().documents.measurements.map(({ name }) => name),
    ["Distance 1", "Distance 2"],
  );
  assert.equal(store.undo(), "add distance");
  assert.equal(store.get().documents.measurements.length, 1);
  assert.equal(store.redo(), "add distance");
  assert.equal(store.get().documents.measurements.length, 2);
  store.undo();
  store.undo();
  assert.equal(store.undo(), null);
  addDistance(store, [samplePoint([0, 0, 0]), samplePoint([3, 0, 0])]);
  assert.equal(store.redo(), null);
});

test("a better point takes no step and is there after undo and redo", () => {
  const store = newStore();
  const picked = samplePoint([0, 0, 0], null);
  const other = samplePoint([3, 0, 0]);
  addDistance(store, [picked, other]);
  store.changeDocuments("rename", (documents) => ({
    ...documents,
    measurements: documents.measurements.map((one) => ({ ...one, name: "wall" })),
  }));
  store.undo();
  store.undo();
  // The field answers while the measurement is undone.
  const found = samplePoint([0, 4, 0], 0.02);
  store.amendDocuments((documents) => replacePoint(documents, picked, found, PROJECT));
  assert.equal(store.get().documents.measurements.length, 0);
  store.redo();
  const [measurement] = store.get().documents.measurements;
  assert.ok(measurement?.kind === "distance");
  assert.equal(measurement.result.slope.value, 5);
  assert.ok(measurement.result.slope.sigma !== null);
  assert.equal(store.redo(), "rename");
  assert.equal(store.get().documents.measurements[0]?.points[0], found);
  assert.equal(store.undo(), "rename");
  assert.equal(store.undo(), "add distance");
  assert.equal(store.undo(), null);
});

test("an amendment of nothing leaves the documents as they are", () => {
  const store = newStore();
  addDistance(store, [samplePoint([0, 0, 0]), samplePoint([1, 0, 0])]);
  store.set({ save: "saved" });
  const before = store.get().documents;
  store.amendDocuments((documents) => replacePoint(documents, samplePoint([0, 0, 0]), samplePoint([9, 9, 9]), PROJECT));
  assert.equal(store.get().documents, before);
  assert.equal(store.get().save, "saved");
});

test("ids and names are free again only when they are not in use", () => {
  let documents: Documents = initialState(sampleProject()).documents;
  for (let i = 0; i < 3; i += 1) documents = withMeasurement(documents, newPoint(documents, [samplePoint([i, 0, 0])]));
  documents = withoutMeasurement(documents, "m2");
  documents = withMeasurement(documents, newPoint(documents, [samplePoint([9, 0, 0])]));
  assert.deepEqual(
    documents.measurements.map(({ id, name }) => `${id} ${name}`),
    ["m1 Point 1", "m3 Point 3", "m4 Point 2"],
  );
  assert.equal(withoutMeasurement(documents, "m9"), documents);
});
