import assert from "node:assert/strict";
import test from "node:test";
import { NO_DOCUMENTS } from "../../../src/state/initial.js";
import { newPoint, withMeasurement } from "../../../src/state/measurements.js";
import { readDocument } from "../../../src/state/persistence.js";
import type { Store } from "../../../src/state/store.js";
import { DocumentsKeeper } from "../../../src/tools/documents_keeper.js";
import { createTools } from "../../../src/tools/tools.js";
import { samplePoint } from "../state/samples.js";
import { type Bench, bench, FakeFiles, settle } from "./fakes.js";

function addPoint(store: Store, x: number): void {
  store.changeDocuments("add point", (documents) =>
    withMeasurement(documents, newPoint(documents, [samplePoint([x, 0, 0])])),
  );
}

function keeper(b: Bench, files: FakeFiles): DocumentsKeeper {
  return new DocumentsKeeper({ project: b.project, store: b.store, clock: b.clock, files });
}

async function pass(b: Bench, ms: number): Promise<void> {
  b.clock.advance(ms);
  await settle();
}

function saved(b: Bench, files: FakeFiles): number[] {
  const text = files.texts.get("measurements.geojson");
  const empty = NO_DOCUMENTS;
  const { measurements } = text === undefined ? empty : readDocument(empty, "measurements.geojson", text, b.project);
  return measurements.map(({ points }) => points[0]?.enu[0] ?? Number.NaN);
}

test("a second after the last change only the file that changed is saved", async () => {
  const b = bench();
  const files = new FakeFiles();
  const own = keeper(b, files);
  await own.load();
  await pass(b, 5000);
  assert.deepEqual(files.saves, []);
  addPoint(b.store, 1);
  await pass(b, 900);
  addPoint(b.store, 2);
  await pass(b, 900);
  assert.deepEqual(files.saves, []);
  assert.equal(b.store.get().save, "unsaved");
  await pass(b, 200);
  assert.deepEqual(files.saves, ["measurements.geojson"]);
  assert.equal(b.store.get().save, "saved");
  assert.deepEqual(saved(b, files), [1, 2]);
  assert.equal(own.unsaved, false);
  // Undone and done again: nothing to save.
  b.store.undo();
  b.store.redo();
  await pass(b, 2000);
  assert.equal(files.saves.length, 1);
  assert.equal(b.store.get().save, "saved");
});

test("what changes while saving is saved afterwards", async () => {
  const b = bench();
  const files = new FakeFiles();
  const own = keeper(b, files);
  await own.load();
  addPoint(b.store, 1);
  let go = () => {};
  files.hold = new Promise((resolve) => {
    go = resolve;
  });
  await pass(b, 1000);
  assert.equal(b.store.get().save, "saving");
  addPoint(b.store, 2);
  await pass(b, 5000);
  assert.equal(files.saves.length, 1);
  files.hold = null;
  go();
  await settle();
  assert.equal(b.store.get().save, "unsaved");
  assert.equal(own.unsaved, true);
  await pass(b, 1000);
  assert.deepEqual(saved(b, files), [1, 2]);
  assert.equal(b.store.get().save, "saved");
});

test("a failure is told once, tried again every 10 seconds and at the next change", async () => {
  const b = bench();
  const files = new FakeFiles();
  const own = keeper(b, files);
  await own.load();
  files.fail = "the disk is full";
  addPoint(b.store, 1);
  await pass(b, 1000);
  assert.equal(b.store.get().save, "failed");
  assert.match(b.store.get().notices[0]?.text ?? "", /measurements\.geojson could not be saved: the disk is full/);
  b.store.set({ notices: [] });
  await pass(b, 10_000);
  assert.equal(files.saves.length, 2);
  assert.deepEqual(b.store.get().notices, []);
  addPoint(b.store, 2);
  await pass(b, 1000);
  assert.equal(files.saves.length, 3);
  files.fail = "";
  await pass(b, 10_000);
  assert.equal(b.store.get().save, "saved");
  assert.deepEqual(saved(b, files), [1, 2]);
  await pass(b, 60_000);
  assert.equal(files.saves.length, 4);
});

test("saved documents are loaded without a step to undo, and not saved again", async () => {
  const b = bench();
  const files = new FakeFiles();
  const first = keeper(b, files);
  await first.load();
  addPoint(b.store, 7);
  await pass(b, 1000);
  const again = bench();
  await keeper(again, files).load();
  assert.deepEqual(again.store.get().documents.measurements, b.store.get().documents.measurements);
  assert.equal(again.store.undo(), null);
  await pass(again, 5000);
  assert.equal(files.saves.length, 1);
});

test("a file that cannot be read is never overwritten, the others are kept", async () => {
  const b = bench();
  const files = new FakeFiles();
  files.texts.set("measurements.geojson", '{"type":"FeatureCollection","features":[]}');
  await keeper(b, files).load();
  assert.match(
    b.store.get().notices[0]?.text ?? "",
    /measurements\.geojson was not loaded: skyquilt: .*not be overwritten/,
  );
  addPoint(b.store, 1);
  b.store.changeDocuments("speed", (documents) => ({
    ...documents,
    cameraPath: { ...documents.cameraPath, speedMps: 3 },
  }));
  await pass(b, 60_000);
  assert.deepEqual(files.saves, ["camera_path.json"]);
  assert.equal(b.store.get().save, "failed");
});

test("a server that does not answer at the start leads to no empty files", async () => {
  const b = bench();
  const files = new FakeFiles();
  files.failLoad = "the server does not answer";
  await keeper(b, files).load();
  addPoint(b.store, 1);
  await pass(b, 60_000);
  assert.deepEqual(files.saves, []);
});

test("what was made before the files were read is kept behind them", async () => {
  const b = bench();
  const files = new FakeFiles();
  const first = keeper(b, files);
  await first.load();
  addPoint(b.store, 1);
  await pass(b, 1000);
  const again = bench();
  const own = keeper(again, files);
  const loading = own.load();
  addPoint(again.store, 2);
  await loading;
  const { measurements } = again.store.get().documents;
  assert.deepEqual(
    measurements.map(({ id, points }) => `${id} ${points[0]?.enu[0]}`),
    ["m1 1", "m2 2"],
  );
  await pass(again, 1000);
  assert.deepEqual(saved(again, files), [1, 2]);
});

test("leaving: a question while something is unsaved, a last save, and one at once in the background", async () => {
  const b = bench();
  const files = new FakeFiles();
  const tools = createTools({ ...b, files, page: b.page as unknown as Window });
  await settle();
  const leave = () => {
    // As BeforeUnloadEvent has it.
    const event = Object.defineProperty(new Event("beforeunload", { cancelable: true }), "returnValue", {
      writable: true,
    });
    b.page.dispatchEvent(event);
    return event.defaultPrevented;
  };
  assert.equal(leave(), false);
  addPoint(b.store, 1);
  assert.equal(leave(), true);
  b.page.dispatchEvent(new Event("pagehide"));
  assert.deepEqual(files.saves, ["measurements.geojson keepalive"]);
  b.page.document.visibilityState = "hidden";
  b.page.dispatchEvent(new Event("visibilitychange"));
  await pass(b, 0);
  // Sent already.
  assert.deepEqual(files.saves.slice(1), []);
  addPoint(b.store, 3);
  b.page.dispatchEvent(new Event("visibilitychange"));
  assert.deepEqual(files.saves.slice(1), ["measurements.geojson keepalive"]);
  await settle();
  await pass(b, 1000);
  assert.equal(leave(), false);
  tools.dispose();
  addPoint(b.store, 2);
  await pass(b, 5000);
  assert.equal(files.saves.length, 2);
});

test("two windows: what both have made is kept, and told once to the one that comes second", async () => {
  const files = new FakeFiles();
  const [one, two] = [bench(), bench()];
  await keeper(one, files).load();
  await keeper(two, files).load();
  addPoint(one.store, 1);
  await pass(one, 1000);
  addPoint(two.store, 2);
  await pass(two, 1000);
  assert.deepEqual(saved(two, files), [1, 2]);
  assert.equal(two.store.get().save, "saved");
  const { documents, notices } = two.store.get();
  assert.deepEqual(
    documents.measurements.map(({ id, points }) => `${id} ${points[0]?.enu[0]}`),
    ["m1 1", "m2 2"],
  );
  assert.deepEqual(
    notices.map(({ kind, text }) => `${kind} ${text}`),
    ["info measurements.geojson was changed in another window: both are kept."],
  );
  // And back; the second time nothing is doubled.
  addPoint(one.store, 3);
  await pass(one, 1000);
  assert.deepEqual(saved(one, files), [1, 2, 3]);
  addPoint(two.store, 4);
  await pass(two, 1000);
  assert.deepEqual(saved(two, files), [1, 2, 3, 4]);
  const { length } = files.saves;
  await pass(one, 60_000);
  await pass(two, 60_000);
  assert.equal(files.saves.length, length);
});

test("a save whose answer was lost is not taken for another window's", async () => {
  const b = bench();
  const files = new FakeFiles();
  await keeper(b, files).load();
  addPoint(b.store, 1);
  files.loseAnswer = true;
  await pass(b, 1000);
  assert.equal(b.store.get().save, "failed");
  files.loseAnswer = false;
  addPoint(b.store, 2);
  b.store.set({ notices: [] });
  await pass(b, 1000);
  assert.deepEqual(saved(b, files), [1, 2]);
  assert.equal(b.store.get().save, "saved");
  assert.deepEqual(b.store.get().notices, []);
});

test("a file that another program has spoilt is left alone from then on", async () => {
  const b = bench();
  const files = new FakeFiles();
  await keeper(b, files).load();
  files.texts.set("gcp.json", "{");
  b.store.changeDocuments("add", (documents) => ({
    ...documents,
    controlPoints: [{ name: "P", xyz: [1, 2, 3], marks: [] }],
  }));
  await pass(b, 1000);
  await pass(b, 60_000);
  assert.equal(files.texts.get("gcp.json"), "{");
  assert.equal(files.saves.length, 1);
  assert.equal(b.store.get().save, "failed");
  assert.match(b.store.get().notices[0]?.text ?? "", /gcp\.json could not be saved: .*cannot be read now/);
});
