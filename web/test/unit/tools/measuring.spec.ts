// Clicks on the canvas to measurements, through everything that createTools joins.
import assert from "node:assert/strict";
import test from "node:test";
import type { VolumeReply } from "../../../src/protocol/link_api.js";
import { newVolume, withMeasurement } from "../../../src/state/measurements.js";
import { remeasureVolume } from "../../../src/state/volumes.js";
import { createTools } from "../../../src/tools/tools.js";
import { samplePoint, sampleProject } from "../state/samples.js";
import { type Bench, bench, FakeFiles, hitAt, NO_HIT, settle } from "./fakes.js";

function start(b: Bench, files = new FakeFiles()): { dispose(): void } {
  return createTools({ ...b, files, page: b.page as unknown as Window });
}

/** Clicks far enough apart in time to be single. */
function click(b: Bench, x: number, y: number, more: Record<string, unknown> = {}): void {
  b.clock.advance(1000);
  b.canvas.click([x, y], more);
}

/** Also those that come meanwhile; answering twice does nothing. */
async function answerPicks(b: Bench): Promise<void> {
  for (let i = 0; ; i += 1) {
    await settle();
    const pick = b.engine.picks[i];
    if (pick === undefined) return;
    const [x, y] = pick.asked.ray.originEnu;
    pick.resolve(hitAt(x, y));
  }
}

const measurements = (b: Bench) => b.store.get().documents.measurements;
const texts = (b: Bench) => b.store.get().notices.map(({ text }) => text);
const VOLUME: VolumeReply = {
  cellM: 0.5,
  cells: 400,
  filled: 1,
  planAreaM2: 10000,
  surfaceAreaM2: 10100,
  cutM3: 30,
  fillM3: 10,
  netM3: 20,
  sigmaM3: 2,
  baseMeanM: 0,
};

test("a distance: the mesh's points at once, the field's later, one step to undo", async () => {
  const b = bench();
  start(b);
  await settle();
  b.page.key("3");
  assert.equal(b.store.get().tool, "distance");
  click(b, 10, 10);
  click(b, 110, 10);
  assert.equal(b.store.get().draft.length, 2);
  const pending = b.engine.picks.length;
  assert.equal(pending <= 1, true);
  b.page.key("Enter");
  const [mesh] = measurements(b);
  assert.ok(mesh?.kind === "distance" && mesh.result.slope.value === 100 && mesh.result.slope.sigma === null);
  assert.equal(b.store.get().draft.length, 0);
  assert.equal(b.store.get().selected, mesh.id);
  await answerPicks(b);
  const [field] = measurements(b);
  assert.ok(field?.kind === "distance" && field.points.every(({ source }) => source === "field"));
  assert.ok(field.result.slope.sigma !== null && field.result.slope.sigma > 0);
  b.page.key("z", { ctrlKey: true });
  assert.equal(measurements(b).length, 0);
  b.page.key("y", { ctrlKey: true });
  assert.deepEqual(measurements(b)[0], field);
});

test("drawing: Backspace and undo take points back, a double click finishes, Escape cancels, then leaves the tool", async () => {
  const b = bench();
  b.store.update(({ engine }) => ({ engine: { ...engine, ready: false } }));
  start(b);
  await settle();
  b.store.set({ tool: "distance" });
  click(b, 10, 10);
  click(b, 20, 10);
  click(b, 30, 10);
  b.page.key("Backspace");
  b.page.key("z", { ctrlKey: true });
  assert.deepEqual(
    b.store.get().draft.map(({ enu }) => enu[0]),
    [10],
  );
  click(b, 50, 10);
  b.canvas.click([50, 10]);
  const [measurement] = measurements(b);
  assert.deepEqual(
    measurement?.points.map(({ enu }) => enu[0]),
    [10, 50],
  );
  click(b, 10, 10);
  b.page.key("Enter");
  assert.match(texts(b).join(), /needs at least 2 points/);
  assert.equal(b.store.get().draft.length, 1);
  b.page.key("Escape");
  assert.equal(b.store.get().draft.length, 0);
  assert.equal(b.store.get().tool, "distance");
  b.page.key("Escape");
  assert.equal(b.store.get().tool, "navigate");
  // The selected one is given up last.
  b.page.key("Escape");
  assert.equal(b.store.get().selected, null);
  assert.equal(measurements(b).length, 1);
});

test("where only the field has a surface, points still come in the order of the clicks", async () => {
  const b = bench();
  start(b);
  await settle();
  b.store.set({ tool: "area" });
  b.holes.add("20,20");
  b.holes.add("30,30");
  click(b, 10, 10);
  click(b, 20, 20);
  click(b, 30, 30);
  click(b, 40, 10);
  b.page.key("Enter");
  assert.equal(measurements(b).length, 0);
  await answerPicks(b);
  const [measurement] = measurements(b);
  assert.deepEqual(
    measurement?.points.map(({ enu }) => enu[0]),
    [10, 20, 30, 40],
  );
  click(b, 20, 20);
  await settle();
  b.engine.picks[b.engine.picks.length - 1]?.resolve(NO_HIT);
  await settle();
  assert.equal(b.store.get().draft.length, 0);
  assert.match(texts(b).join(), /no surface/);
});

test("an outline closes at its first corner and must not cross itself", async () => {
  const b = bench();
  b.store.update(({ engine }) => ({ engine: { ...engine, ready: false } }));
  start(b);
  await settle();
  b.store.set({ tool: "area" });
  for (const [x, y] of [
    [10, 10],
    [110, 110],
    [110, 10],
    [10, 110],
  ] as const)
    click(b, x, y);
  b.page.key("Enter");
  assert.match(texts(b).join(), /crosses/);
  assert.equal(measurements(b).length, 0);
  b.page.key("Backspace");
  click(b, 12, 12);
  const [measurement] = measurements(b);
  assert.ok(measurement?.kind === "area");
  assert.equal(measurement.result.plan.value, 5000);
});

test("a profile is asked between the field's points; when it fails the draft stays for another try", async () => {
  const b = bench();
  start(b);
  await settle();
  b.store.set({ tool: "profile" });
  click(b, 10, 10);
  click(b, 60, 10);
  assert.equal(b.engine.profiles.length, 0);
  await answerPicks(b);
  const [asked] = b.engine.profiles;
  assert.deepEqual(asked?.asked, { from: [10, -10], to: [60, -10], samples: 512, project: "main" });
  b.page.key("Enter");
  await settle();
  assert.equal(b.engine.profiles.length, 1);
  asked?.reject(new Error("the engine is gone"));
  await settle();
  assert.match(texts(b).join(), /the engine is gone/);
  assert.equal(b.store.get().draft.length, 2);
  b.page.key("Enter");
  await settle();
  b.engine.profiles[1]?.resolve({ lengthM: 50, heightsM: [1, null], spreadsM: [0.1, null] });
  await settle();
  const [profile] = measurements(b);
  assert.ok(profile?.kind === "profile" && profile.lengthM === 50);
  assert.ok(profile.points.every(({ source }) => source === "field"));
  assert.equal(b.store.get().draft.length, 0);
});

test("what is cancelled while the engine measures does not come after all; a new outline leaves the old one alone", async () => {
  const b = bench();
  b.store.set({ volumeBase: "height", volumeBaseHeightM: 7 });
  start(b);
  await settle();
  b.store.set({ tool: "volume" });
  const draw = async (shift: number) => {
    for (const [x, y] of [
      [100, 100],
      [200, 100],
      [200, 200],
    ] as const)
      click(b, x + shift, y);
    b.page.key("Enter");
    await answerPicks(b);
  };
  await draw(0);
  assert.equal(b.engine.volumes.length, 1);
  b.page.key("Escape");
  b.engine.volumes[0]?.resolve(VOLUME);
  await settle();
  assert.equal(measurements(b).length, 0);
  await draw(10);
  click(b, 400, 400);
  assert.deepEqual(
    b.store.get().draft.map(({ enu }) => enu[0]),
    [400],
  );
  b.engine.volumes[1]?.resolve(VOLUME);
  await settle();
  const [volume] = measurements(b);
  assert.ok(volume?.kind === "volume" && volume.base === "height" && volume.baseHeightM === 7);
  assert.deepEqual(b.engine.volumes[1]?.asked, {
    polygon: [
      [110, -100],
      [210, -100],
      [210, -200],
    ],
    base: "height",
    baseHeightM: 7,
    project: "main",
  });
  assert.ok((volume.result.net.sigma ?? 0) >= 2);
  assert.equal(b.store.get().draft.length, 1);
});

test("a finished volume over another base is one step; answers of older requests are dropped", async () => {
  const b = bench();
  start(b);
  await settle();
  b.store.set({ tool: "volume" });
  for (const [x, y] of [
    [100, 100],
    [200, 100],
    [200, 200],
  ] as const)
    click(b, x, y);
  b.page.key("Enter");
  await answerPicks(b);
  b.engine.volumes[0]?.resolve(VOLUME);
  await settle();
  const [volume] = measurements(b);
  assert.ok(volume !== undefined);
  const first = remeasureVolume(b.store, b.link, b.project, volume.id, "lowest", 0);
  const second = remeasureVolume(b.store, b.link, b.project, volume.id, "height", 3);
  b.engine.volumes[2]?.resolve({ ...VOLUME, netM3: 33 });
  b.engine.volumes[1]?.resolve({ ...VOLUME, netM3: 22 });
  await Promise.all([first, second]);
  const [changed] = measurements(b);
  assert.ok(changed?.kind === "volume" && changed.base === "height" && changed.baseHeightM === 3);
  assert.equal(changed.result.net.value, 33);
  b.store.undo();
  assert.deepEqual(measurements(b)[0], volume);
});

test("without an earlier survey the base `before` is refused before the engine is asked", async () => {
  const b = bench();
  b.store.set({ volumeBase: "before" });
  start(b);
  await settle();
  b.store.set({ tool: "volume" });
  for (const [x, y] of [
    [100, 100],
    [200, 100],
    [200, 200],
  ] as const)
    click(b, x, y);
  b.page.key("Enter");
  await answerPicks(b);
  assert.equal(b.engine.volumes.length, 0);
  assert.match(texts(b).join(), /--compare/);
});

test("another tool ends the draft", async () => {
  const b = bench();
  start(b);
  await settle();
  b.store.set({ tool: "area" });
  click(b, 10, 10);
  b.store.set({ tool: "navigate" });
  assert.equal(b.store.get().draft.length, 0);
  await answerPicks(b);
  assert.equal(b.store.get().draft.length, 0);
  assert.equal(measurements(b).length, 0);
});

test("left of the swipe's line profiles and volumes ask the earlier survey; points on both sides have no answer", async () => {
  const before = { ...sampleProject({ name: "last year" }), enuFromBefore: [] };
  const b = bench({ before });
  b.store.set({ swipe: { on: true, at: 0.5 } });
  start(b);
  await settle();
  b.store.set({ tool: "profile" });
  click(b, 10, 10);
  click(b, 60, 10);
  // The line moves on; what was clicked stays where it was seen.
  b.store.set({ swipe: { on: true, at: 0 } });
  await answerPicks(b);
  assert.equal(b.engine.profiles[0]?.asked.project, "before");
  b.engine.profiles[0]?.resolve({ lengthM: 50, heightsM: [1, 2], spreadsM: [0.1, 0.1] });
  await settle();
  const [profile] = measurements(b);
  assert.ok(profile?.kind === "profile" && profile.survey === "before");
  b.store.set({ swipe: { on: true, at: 0.5 }, tool: "volume" });
  const corners = async (...places: readonly (readonly [number, number])[]) => {
    for (const [x, y] of places) click(b, x, y);
    b.page.key("Enter");
    await answerPicks(b);
  };
  await corners([300, 100], [500, 100], [500, 200]);
  assert.equal(b.engine.volumes.length, 0);
  assert.match(texts(b).join(), /both sides of the line/);
  b.store.set({ volumeBase: "before" });
  b.page.key("Enter");
  await settle();
  assert.equal(b.engine.volumes[0]?.asked.project, "main");
  b.engine.volumes[0]?.resolve(VOLUME);
  await settle();
  b.store.set({ volumeBase: "plane" });
  await corners([100, 100], [200, 100], [200, 200]);
  assert.equal(b.engine.volumes[1]?.asked.project, "before");
});

test("a volume measured again changes only the volume that was asked for", async () => {
  const b = bench();
  const points = [0, 10, 20].map((x) => samplePoint([x, x * x, 0]));
  const result = { cut: 1, fill: 1, net: { value: 0, sigma: null }, surfaceArea: 1, filled: 1, cellM: 1 };
  const add = () =>
    b.store.changeDocuments("add", (documents) =>
      withMeasurement(documents, newVolume(documents, [...points], "plane", null, result)),
    );
  add();
  const asked = remeasureVolume(b.store, b.link, b.project, "m1", "lowest", 0);
  b.store.undo();
  add();
  b.engine.volumes[0]?.resolve(VOLUME);
  await asked;
  const [volume] = measurements(b);
  assert.ok(volume?.kind === "volume" && volume.id === "m1" && volume.base === "plane");
});

test('"." places points in the middle of the view, with a tool only', async () => {
  const b = bench();
  start(b);
  await settle();
  b.page.key(".");
  assert.equal(b.store.get().draft.length, 0);
  b.store.set({ tool: "distance" });
  b.page.key(".");
  assert.deepEqual(
    b.store.get().draft.map(({ enu }) => enu),
    [[400, -300, 0]],
  );
});
