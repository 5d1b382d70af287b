// tour.json as a saved document: rights, and two windows that change it.
import assert from "node:assert/strict";
import test from "node:test";
import type { CommandTable } from "../../../src/state/commands.js";
import type { Store } from "../../../src/state/store.js";
import { changeTour } from "../../../src/state/tour_changes.js";
import type { Rights } from "../../../src/state/tour_state.js";
import { DocumentsKeeper } from "../../../src/tools/documents_keeper.js";
import { createTools } from "../../../src/tools/tools.js";
import { setTitle } from "../../../src/tour/edit_stops.js";
import { writeTour } from "../../../src/tour/write.js";
import { sampleFile } from "../tour/samples.js";
import { type Bench, bench, FakeFiles, settle } from "./fakes.js";
import { EDITOR, rowOfStops, VISITOR } from "./tour_samples.js";

const FILE = "tour.json";

async function pass(b: Bench, ms: number): Promise<void> {
  b.clock.advance(ms);
  await settle();
}

async function window(
  files: FakeFiles,
  rights: Rights = EDITOR,
): Promise<Bench & { readonly keeper: DocumentsKeeper }> {
  const b = bench({}, rights);
  const keeper = new DocumentsKeeper({ project: b.project, store: b.store, clock: b.clock, files });
  await keeper.load();
  return { ...b, keeper };
}

function name(store: Store, title: string): void {
  changeTour(store, "change title", (tour) => setTitle(tour, title));
}

const titleIn = (files: FakeFiles): string => JSON.parse(files.texts.get(FILE) ?? '{"title":null}').title;
const titleOf = (b: Bench): string => b.store.get().documents.tour.title;

/** Two windows; the first has saved "one", the second "two" only in its page. */
async function quarrel() {
  const files = new FakeFiles();
  const [one, two] = [await window(files), await window(files)];
  name(one.store, "one");
  await pass(one, 1000);
  name(two.store, "two");
  await pass(two, 1000);
  return { files, one, two };
}

test("a tour is saved a second after its last change, by undo too, and read again as it was", async () => {
  const files = new FakeFiles();
  const b = await window(files);
  assert.equal(b.store.get().tour.locked, null);
  changeTour(b.store, "make", () => rowOfStops());
  await pass(b, 1000);
  assert.deepEqual(files.saves, [FILE]);
  assert.deepEqual((await window(files)).store.get().documents.tour, b.store.get().documents.tour);
  b.store.undo();
  await pass(b, 1000);
  assert.equal(JSON.parse(files.texts.get(FILE) ?? "").stops.length, 0);
});

test("without the right the tour can be played, but neither changed nor saved", async () => {
  const files = new FakeFiles();
  files.texts.set(FILE, JSON.stringify(sampleFile()));
  const b = await window(files, { documents: true, tour: false });
  assert.equal(b.store.get().documents.tour.stops.length, 3);
  assert.match(b.store.get().tour.locked ?? "", /--edit/);
  name(b.store, "mine");
  assert.notEqual(titleOf(b), "mine");
  b.store.changeDocuments("speed", (documents) => ({ ...documents, cameraPath: { keys: [], speedMps: 2 } }));
  await pass(b, 20_000);
  assert.deepEqual(files.saves, ["camera_path.json"]);
});

test("who may only look saves nothing at all, and is not asked when leaving", async () => {
  const files = new FakeFiles();
  const b = await window(files, VISITOR);
  b.store.changeDocuments("speed", (documents) => ({ ...documents, cameraPath: { keys: [], speedMps: 2 } }));
  await pass(b, 20_000);
  b.keeper.flush();
  assert.equal(b.keeper.unsaved, false);
  assert.deepEqual(files.saves, []);
});

test("a tour of another version is played by its editor too, but never overwritten", async () => {
  const files = new FakeFiles();
  const text = JSON.stringify({ ...sampleFile(), version: 2, weather: "rain" });
  files.texts.set(FILE, text);
  const b = await window(files);
  assert.equal(b.store.get().documents.tour.stops.length, 3);
  assert.match(b.store.get().tour.locked ?? "", /not changed here: version/);
  assert.ok(b.store.get().tour.missing.some((sentence) => sentence.includes("version 2")));
  name(b.store, "mine");
  // Not even by a change that comes past the lock.
  b.store.changeDocuments("x", (documents) => ({ ...documents, tour: rowOfStops() }));
  await pass(b, 20_000);
  assert.equal(files.texts.get(FILE), text);
});

test("a damaged tour is told, locked and left alone", async () => {
  const files = new FakeFiles();
  files.texts.set(FILE, '{"version":1,"stops":7}');
  const b = await window(files);
  assert.match(b.store.get().tour.locked ?? "", /tour\.json was not loaded: stops: a list expected/);
  b.store.changeDocuments("x", (documents) => ({ ...documents, tour: rowOfStops() }));
  await pass(b, 20_000);
  assert.deepEqual(files.saves, []);
});

test("the second window is told, overwrites nothing and keeps its changes until somebody decides", async () => {
  const { files, two } = await quarrel();
  assert.equal(titleIn(files), "one");
  assert.equal(titleOf(two), "two");
  const { tour, notices, save } = two.store.get();
  assert.equal(tour.conflict, true);
  assert.equal(save, "failed");
  assert.deepEqual(
    notices.map(({ kind, actions }) => [kind, actions.map(({ command }) => command)]),
    [["error", ["tour.takeOther", "tour.keepMine"]]],
  );
  name(two.store, "two again");
  await pass(two, 60_000);
  two.keeper.flush();
  await pass(two, 1000);
  assert.equal(titleIn(files), "one");
  assert.equal(files.saves.length, 2);
  assert.equal(two.keeper.unsaved, true);
  // Other documents are still saved.
  two.store.changeDocuments("speed", (documents) => ({ ...documents, cameraPath: { keys: [], speedMps: 2 } }));
  await pass(two, 1000);
  assert.deepEqual(files.saves.slice(2), ["camera_path.json"]);
  assert.equal(two.store.get().save, "failed");
});

test("the other version can be taken; undo brings back one's own, which is saved then", async () => {
  const { files, two } = await quarrel();
  await two.keeper.conflict.takeOther();
  assert.equal(titleOf(two), "one");
  assert.equal(two.store.get().tour.conflict, false);
  assert.ok(two.store.get().notices.every(({ actions }) => actions.length === 0));
  await pass(two, 20_000);
  assert.equal(two.store.get().save, "saved");
  assert.equal(files.saves.length, 2);
  two.store.undo();
  await pass(two, 1000);
  assert.equal(titleIn(files), "two");
});

test("one's own can be kept: it replaces the version that was told of", async () => {
  const { files, one, two } = await quarrel();
  two.keeper.conflict.keepMine();
  await pass(two, 1000);
  assert.equal(titleIn(files), "two");
  assert.equal(two.store.get().save, "saved");
  // Now the first window is the one that is told.
  name(one.store, "three");
  await pass(one, 1000);
  assert.equal(one.store.get().tour.conflict, true);
  assert.equal(titleIn(files), "two");
});

test("what was saved after somebody was told is told again before it is replaced", async () => {
  const { files, one, two } = await quarrel();
  name(one.store, "newer");
  await pass(one, 1000);
  two.keeper.conflict.keepMine();
  await pass(two, 1000);
  assert.equal(titleIn(files), "newer");
  assert.equal(two.store.get().tour.conflict, true);
  assert.equal(two.store.get().notices.length, 1);
  two.keeper.conflict.keepMine();
  await pass(two, 1000);
  assert.equal(titleIn(files), "two");
});

test("a save whose answer was lost is no other window", async () => {
  const files = new FakeFiles();
  const b = await window(files);
  name(b.store, "one");
  files.loseAnswer = true;
  await pass(b, 1000);
  files.loseAnswer = false;
  name(b.store, "two");
  await pass(b, 1000);
  assert.equal(titleIn(files), "two");
  assert.equal(b.store.get().tour.conflict, false);
});

test("a page that is left while a save is under way saves what was changed last, whichever comes first", async () => {
  for (const late of [false, true]) {
    const files = new FakeFiles();
    const b = await window(files);
    name(b.store, "one");
    let go = () => {};
    files.hold = new Promise((resolve) => {
      go = resolve;
    });
    await pass(b, 1000);
    name(b.store, "two");
    if (late) files.hold = null;
    b.keeper.flush();
    // Chromium tells of a hidden page after it was left.
    b.keeper.flush();
    assert.deepEqual(files.saves, [FILE, `${FILE} keepalive`]);
    if (late) await settle();
    go();
    await settle();
    assert.equal(titleIn(files), "two");
    // Where it stays, nobody is asked anything.
    await pass(b, 2000);
    assert.equal(b.store.get().tour.conflict, false);
    assert.equal(b.store.get().save, "saved");
    assert.equal(files.saves.length, 2);
  }
});

test("a page that is left while a save is under way does not overwrite what another window saves", async () => {
  const files = new FakeFiles();
  const b = await window(files);
  name(b.store, "one");
  let go = () => {};
  files.hold = new Promise((resolve) => {
    go = resolve;
  });
  await pass(b, 1000);
  name(b.store, "two");
  b.keeper.flush();
  files.texts.set(FILE, writeTour(setTitle(rowOfStops(), "of another window")));
  go();
  await settle();
  assert.equal(titleIn(files), "of another window");
});

test("a save whose answer was lost is recognised in the server's own spacing", async () => {
  const files = new FakeFiles();
  const b = await window(files);
  name(b.store, "one");
  files.loseAnswer = true;
  await pass(b, 1000);
  files.loseAnswer = false;
  files.texts.set(FILE, `${JSON.stringify(JSON.parse(files.texts.get(FILE) ?? ""), null, 1)}\n`);
  name(b.store, "two");
  await pass(b, 1000);
  assert.equal(titleIn(files), "two");
  assert.equal(b.store.get().tour.conflict, false);
});

test("the buttons of the message run the commands, and play mode opens by itself for visitors", async () => {
  const { files } = await quarrel();
  const b = bench({}, VISITOR);
  files.texts.set(FILE, writeTour(rowOfStops()));
  const page = Object.assign(b.page, { matchMedia: () => ({ matches: true }) });
  createTools({ ...b, files, page: page as unknown as Window });
  await settle();
  assert.equal(b.store.get().play?.stop?.id, "stop-1");
  const table: CommandTable = b.commands;
  assert.equal(table.enabled("tour.keepMine"), false);
  assert.equal(table.enabled("tour.addStop"), false);
});
