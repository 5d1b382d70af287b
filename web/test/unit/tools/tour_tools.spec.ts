// Placing things by clicks, commands and keys of the tour, and what the scene shows of it.
import assert from "node:assert/strict";
import test from "node:test";
import type { SceneThing } from "../../../src/scene/thing.js";
import type { SurfacePoint } from "../../../src/state/app_state.js";
import { changeTour, setTourView } from "../../../src/state/tour_changes.js";
import type { Placing } from "../../../src/state/tour_state.js";
import { addBranchTo, retargetBranch, setWay, wayOf } from "../../../src/state/tour_ways.js";
import { createTools } from "../../../src/tools/tools.js";
import { listenToMarkers } from "../../../src/tools/tour_markers.js";
import { showTourThings } from "../../../src/tools/tour_things.js";
import { addBranch, changeBranch } from "../../../src/tour/edit_stops.js";
import { addThing, newLabel, newMarker, renameThing, showAtStops } from "../../../src/tour/edit_things.js";
import { type Bench, bench, FakeFiles, hitAt, settle } from "./fakes.js";
import { EDITOR, openTour, playing, rowOfStops } from "./tour_samples.js";

async function editor(): Promise<Bench> {
  const b = bench({}, EDITOR);
  const page = Object.assign(b.page, { matchMedia: () => ({ matches: true }) });
  // As the scene has it without models.
  const scene = Object.assign(b.scene, { pickPlace: (px: [number, number]) => b.scene.pickSurface(px) });
  createTools({ ...b, scene, files: new FakeFiles(), page: page as unknown as Window });
  await settle();
  openTour(b.store, rowOfStops());
  return b;
}

function place(b: Bench, placing: Placing): void {
  setTourView(b.store, { placing });
  b.store.set({ tool: "thing" });
}

async function click(b: Bench, x: number, y: number, more: Record<string, unknown> = {}): Promise<void> {
  b.clock.advance(1000);
  b.canvas.click([x, y], more);
  await settle();
}

async function answer(b: Bench): Promise<void> {
  const pick = b.engine.picks.at(-1);
  const [x, y] = pick?.asked.ray.originEnu ?? [0, 0];
  pick?.resolve(hitAt(x, y));
  await settle();
}

const things = (b: Bench) => b.store.get().documents.tour.things;

test("a label is placed on the surface at once, and takes the field's place without a step of its own", async () => {
  const b = await editor();
  place(b, { kind: "label" });
  await click(b, 10, 20);
  assert.deepEqual(
    things(b).map(({ id, kind, at }) => [id, kind, at]),
    [["label-1", "label", [10, -20, 0]]],
  );
  const { tool, panel, tour } = b.store.get();
  assert.deepEqual([tool, panel, tour.thing, tour.placing], ["navigate", "tour", "label-1", null]);
  await answer(b);
  assert.deepEqual(things(b)[0]?.at, [10, -20, 0.5]);
  assert.equal(b.store.undo(), "add label");
  assert.equal(things(b).length, 0);
  b.store.redo();
  assert.deepEqual(things(b)[0]?.at, [10, -20, 0.5]);
});

test("Shift places one after the other, a model stands on a model, and where only the field is it is asked", async () => {
  const b = await editor();
  place(b, { kind: "marker" });
  await click(b, 10, 20, { shiftKey: true });
  await answer(b);
  assert.equal(b.store.get().tool, "thing");
  const onModel: SurfacePoint = {
    enu: [30, -30, 7],
    direction: [0, 0, -1],
    spreadM: null,
    pixelM: 0.1,
    source: "mesh",
  };
  Object.assign(b.scene, { pickPlace: () => onModel });
  await click(b, 30, 30, { shiftKey: true });
  await answer(b);
  assert.deepEqual(things(b)[1]?.at, [30, -30, 7]);
  Object.assign(b.scene, { pickPlace: () => null });
  b.holes.add("40,40");
  await click(b, 40, 40);
  assert.equal(things(b).length, 2);
  await answer(b);
  assert.deepEqual(things(b)[2]?.at, [40, -40, 0.5]);
});

test("a model keeps its file with it, is moved by another click, and the middle of a way is picked", async () => {
  const b = await editor();
  const asset = { file: `${"ab".repeat(32)}.glb`, name: "House.GLB", bytes: 12 };
  place(b, { kind: "model", asset });
  await click(b, 10, 20);
  await answer(b);
  const [model] = things(b);
  assert.ok(model?.kind === "model" && model.name === "House");
  assert.deepEqual(b.store.get().documents.tour.assets.get(asset.file), { name: "House.GLB", bytes: 12 });
  place(b, { kind: "move", thing: model.id });
  await click(b, 50, 60);
  assert.deepEqual(things(b)[0]?.at, [50, -60, 0]);
  await answer(b);
  assert.deepEqual(things(b)[0]?.at, [50, -60, 0.5]);
  changeTour(b.store, "way", (tour) => {
    const branched = addBranch(tour, "stop-1", { to: "stop-3", label: "x", path: { kind: "over" } });
    return setWay(branched, "stop-1", null, { kind: "orbit", about: [0, 0, 0] });
  });
  place(b, { kind: "centre", stop: "stop-1", branch: null });
  await click(b, 5, 6);
  await answer(b);
  assert.deepEqual(wayOf(b.store.get().documents.tour, "stop-1", null), { kind: "orbit", about: [5, -6, 0.5] });
  place(b, { kind: "centre", stop: "stop-1", branch: 0 });
  await click(b, 7, 8);
  assert.deepEqual(wayOf(b.store.get().documents.tour, "stop-1", 0), { kind: "orbit", about: [7, -8, 0] });
});

test("the keyboard places in the middle of the view, Escape ends the tool, a locked tour has none", async () => {
  const b = await editor();
  b.page.key("9");
  assert.deepEqual(b.store.get().tour.placing, { kind: "label" });
  b.page.key(".");
  assert.deepEqual(things(b)[0]?.at, [400, -300, 0]);
  b.page.key("9");
  b.page.key("Escape");
  assert.deepEqual([b.store.get().tool, b.store.get().tour.placing], ["navigate", null]);
  setTourView(b.store, { locked: "no right" });
  b.page.key("9");
  assert.equal(b.store.get().tool, "navigate");
  b.page.key("K", { shiftKey: true });
  assert.equal(b.store.get().documents.tour.stops.length, 3);
});

test("keys add stops and play them; while a tour is played its keys come before the camera's", async () => {
  const b = await editor();
  b.page.key("K", { shiftKey: true });
  assert.deepEqual(
    b.store.get().documents.tour.stops.map(({ title }) => title),
    ["Stop 1", "Stop 2", "Stop 3", "Stop 4"],
  );
  b.page.key("U", { shiftKey: true });
  assert.equal(b.store.get().play?.stop?.id, "stop-1");
  const moved = b.page.key("ArrowRight");
  assert.ok(moved.defaultPrevented);
  assert.equal(b.store.get().play?.stop?.id, "stop-2");
  b.page.key("ArrowLeft");
  assert.equal(b.store.get().play?.stop?.id, "stop-1");
  b.page.key(" ");
  assert.equal(b.store.get().play?.playing, true);
  // Nothing that writes.
  b.page.key("z", { ctrlKey: true });
  b.page.key("K", { shiftKey: true });
  b.page.key("2");
  assert.equal(b.store.get().documents.tour.stops.length, 4);
  assert.equal(b.store.get().tool, "navigate");
  b.page.key("Escape");
  assert.equal(b.store.get().play, null);
  assert.equal(b.page.key("ArrowRight").defaultPrevented, false);
});

test("a click selects a thing of the tour, in a tour that is played it does nothing", async () => {
  const b = await editor();
  Object.assign(b.scene, { pickThing: () => "label-1" });
  changeTour(b.store, "add", (tour) => addThing(tour, newLabel(tour, "Oak", [0, 0, 0])));
  await click(b, 10, 10);
  assert.equal(b.store.get().tour.thing, "label-1");
  assert.equal(b.store.get().panel, "tour");
  b.page.key("Escape");
  assert.equal(b.store.get().tour.thing, null);
  await b.commands.run("tour.play");
  await click(b, 20, 20);
  assert.equal(b.store.get().tour.thing, null);
});

test("the scene gets all things while the tour is made and those of the stop while it is played, the same ones again", () => {
  const b = bench({}, EDITOR);
  const lists: (readonly SceneThing[])[] = [];
  const highlights: (string | null)[] = [];
  const scene = {
    setThings: (list: readonly SceneThing[]) => void lists.push(list),
    highlightThings: (selected: string | null) => void highlights.push(selected),
    invalidate: () => {},
  };
  const end = showTourThings(b.store, scene, (asset) => `/x/${asset}`);
  let tour = rowOfStops();
  tour = addThing(tour, newLabel(tour, "Oak", [1, 2, 3]));
  tour = addThing(tour, newMarker(tour, "Door", [4, 5, 6], "stop-2"));
  tour = showAtStops(tour, "marker-1", ["stop-2"]);
  openTour(b.store, tour);
  assert.deepEqual(
    lists.at(-1)?.map(({ id }) => id),
    ["label-1", "marker-1"],
  );
  changeTour(b.store, "rename", (old) => renameThing(old, "marker-1", "Gate"));
  assert.equal(lists.at(-1)?.[0], lists.at(-2)?.[0]);
  assert.notEqual(lists.at(-1)?.[1], lists.at(-2)?.[1]);
  b.store.set({ play: playing(b.store.get().documents.tour) });
  assert.deepEqual(
    lists.at(-1)?.map(({ id }) => id),
    ["label-1"],
  );
  b.store.set({ play: null, layers: { ...b.store.get().layers, things: false } });
  assert.deepEqual(lists.at(-1), []);
  b.store.set({ panel: "tour" });
  setTourView(b.store, { thing: "label-1" });
  assert.equal(highlights.at(-1), "label-1");
  const { length } = lists;
  end();
  b.store.set({ layers: { ...b.store.get().layers, things: true } });
  assert.equal(lists.length, length);
});

test("a marker leads on in a tour that is played, and is opened by whoever makes it", () => {
  const b = bench({}, EDITOR);
  let chosen = (_: string) => {};
  const gone: string[] = [];
  const scene = {
    flyTo: () => Promise.resolve(),
    onThingChosen: (listener: (id: string) => void) => {
      chosen = listener;
      return () => {};
    },
  };
  listenToMarkers(b.store, scene, { goTo: (stop) => void gone.push(stop) });
  const tour = rowOfStops();
  openTour(b.store, addThing(tour, newMarker(tour, "Door", [0, 0, 0], "stop-3")));
  chosen("marker-1");
  assert.equal(b.store.get().tour.thing, "marker-1");
  assert.deepEqual(gone, []);
  b.store.set({ play: playing(b.store.get().documents.tour) });
  chosen("marker-1");
  chosen("nothing");
  assert.deepEqual(gone, ["stop-3"]);
});

test("a branch is called as its stop until somebody gives it a name", () => {
  const branches = (tour: ReturnType<typeof rowOfStops>) => tour.stops[0]?.branches.map(({ to, label }) => [to, label]);
  let tour = addBranchTo(rowOfStops(), "stop-1", "stop-2");
  assert.deepEqual(branches(tour), [["stop-2", "Stop 2"]]);
  tour = retargetBranch(tour, "stop-1", 0, "stop-3");
  assert.deepEqual(branches(tour), [["stop-3", "Stop 3"]]);
  tour = retargetBranch(changeBranch(tour, "stop-1", 0, { label: "Up" }), "stop-1", 0, "stop-2");
  assert.deepEqual(branches(tour), [["stop-2", "Up"]]);
  assert.equal(retargetBranch(tour, "stop-1", 0, "nowhere"), tour);
});
