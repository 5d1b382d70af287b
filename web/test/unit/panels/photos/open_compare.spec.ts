import assert from "node:assert/strict";
import test from "node:test";
import type { AppContext } from "../../../../src/panels/context.js";
import { openCompare } from "../../../../src/panels/photos/open_compare.js";
import type { CameraPose } from "../../../../src/state/app_state.js";
import { initialState } from "../../../../src/state/initial.js";
import type { Photo } from "../../../../src/state/project.js";
import { Store } from "../../../../src/state/store.js";
import { sampleProject } from "../../state/samples.js";

const photo = (index: number): Photo => ({
  index,
  name: `${index}.jpg`,
  camera: 0,
  position: [10 * index, 0, 50],
  rotation: [0, 1, 0, 0],
  isTest: false,
  psnrDb: null,
  available: true,
});

test("only the newest photo is opened, and only when the camera has arrived", async () => {
  const cameras = [{ model: "PINHOLE", width: 40, height: 30, params: [30, 30, 20, 15] }];
  const project = sampleProject({ photos: [photo(0), photo(1), photo(2)], cameras });
  const store = new Store(initialState(project));
  const flights: { pose: CameraPose; end: () => void }[] = [];
  let pose: CameraPose = { eyeEnu: [0, 0, 500], rotation: [0, 1, 0, 0], fovyDeg: 50, orthoHeightM: null };
  const scene = {
    pose: () => pose,
    flyTo: (to: CameraPose) => new Promise<void>((end) => flights.push({ pose: to, end })),
  };
  const context = { project, store, scene } as unknown as AppContext;
  const arrive = (i: number) => {
    pose = flights[i]?.pose ?? pose;
    flights[i]?.end();
  };
  const first = openCompare(context, photo(0));
  const second = openCompare(context, photo(1));
  arrive(0);
  await first;
  assert.equal(store.get().compare, null);
  arrive(1);
  await second;
  assert.equal(store.get().compare?.photo, 1);
  store.set({ compare: null });
  const third = openCompare(context, photo(2));
  flights[2]?.end();
  await third;
  assert.equal(store.get().compare, null);
});
