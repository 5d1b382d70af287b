import assert from "node:assert/strict";
import test from "node:test";
import { keepBuildings } from "../../../src/entry/buildings_loader.js";
import type { BuildingSet } from "../../../src/state/buildings.js";
import { initialState } from "../../../src/state/initial.js";
import { Store } from "../../../src/state/store.js";
import { sampleBuilding, sampleSet } from "../state/building_samples.js";
import { sampleProject } from "../state/samples.js";

const URL = "/data/buildings/buildings.json";
const PROJECT = sampleProject({ buildings: { count: 1, url: URL, files: [] } });

async function settle(): Promise<void> {
  for (let i = 0; i < 10; i += 1) await Promise.resolve();
}

function bench(load: (url: string) => Promise<BuildingSet>, project = PROJECT): { store: Store; end: () => void } {
  const store = new Store(initialState(project));
  return { store, end: keepBuildings(store, project, load) };
}

function show(store: Store, on: boolean): void {
  store.update(({ layers }) => ({ layers: { ...layers, buildings: on } }));
}

test("buildings are loaded once, when they are wanted", async () => {
  const urls: string[] = [];
  const set = sampleSet([sampleBuilding(1)]);
  const { store } = bench(async (url) => {
    urls.push(url);
    return set;
  });
  await settle();
  assert.deepEqual(urls, [], "nobody has asked for them");
  store.set({ panel: "buildings" });
  assert.equal(store.get().layers.buildings, true, "their panel shows them");
  assert.equal(store.get().buildings.loading, true);
  await settle();
  assert.equal(store.get().buildings.set, set);
  show(store, false);
  show(store, true);
  await settle();
  assert.deepEqual(urls, [URL]);
});

test("what could not be loaded is said and tried again", async () => {
  let fails = true;
  const { store } = bench(async () => {
    if (fails) throw new Error("the server does not answer");
    return sampleSet([]);
  });
  show(store, true);
  await settle();
  const { buildings, layers, notices } = store.get();
  assert.equal(buildings.error, "the server does not answer");
  assert.equal(layers.buildings, false, "the switch does not claim that they are shown");
  assert.match(notices[0]?.text ?? "", /the server does not answer/);
  fails = false;
  show(store, true);
  await settle();
  assert.deepEqual(store.get().buildings, { set: sampleSet([]), loading: false, error: "" });
});

test("without buildings, and after the end, nothing is asked for", async () => {
  const never = () => Promise.reject(new Error("not expected"));
  const without = bench(never, sampleProject());
  without.store.set({ panel: "buildings" });
  const ended = bench(never);
  ended.end();
  show(ended.store, true);
  await settle();
  for (const { store } of [without, ended]) assert.deepEqual(store.get().notices, []);
});
