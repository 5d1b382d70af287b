import assert from "node:assert/strict";
import test from "node:test";
import { CheckError } from "../../../src/base/check.js";
import { History } from "../../../src/state/history.js";
import {
  addBranch,
  addStop,
  changeBranch,
  changeStop,
  moveBranch,
  moveStop,
  newStop,
  removeBranch,
  removeStop,
  setNext,
  setPicture,
  setStart,
  setTitle,
} from "../../../src/tour/edit_stops.js";
import {
  addThing,
  moveThing,
  newLabel,
  newMarker,
  newModel,
  removeThing,
  renameThing,
  scaleThing,
  setTarget,
  showAtStops,
  thingOf,
  turnThing,
} from "../../../src/tour/edit_things.js";
import { EMPTY_TOUR, stopOf, type Tour } from "../../../src/tour/types.js";
import { writeTour } from "../../../src/tour/write.js";
import { MODEL, PICTURE, pose, sampleTour } from "./samples.js";

function order(tour: Tour): string {
  return tour.stops.map(({ id }) => id).join("");
}

test("a tour is made from nothing, saved at every step", () => {
  let tour = setTitle(EMPTY_TOUR, "Village");
  for (const title of ["One", "Two", "Three"]) tour = addStop(tour, newStop(tour, title, pose([0, 0, 5])));
  assert.deepEqual(
    tour.stops.map(({ id, title }) => `${id} ${title}`),
    ["stop-1 One", "stop-2 Two", "stop-3 Three"],
  );
  tour = addStop(tour, newStop(tour, "Zero", pose([0, 0, 5])), 0);
  assert.equal(tour.stops[0]?.id, "stop-4");
  writeTour(tour);
  tour = addBranch(tour, "stop-4", { to: "stop-2", label: "Across", path: { kind: "over" } });
  tour = setNext(tour, "stop-3", { to: "stop-4", path: { kind: "direct" } });
  tour = addThing(tour, newLabel(tour, "Oak", [1, 2, 3]));
  tour = addThing(tour, newLabel(tour, "Elm", [1, 2, 3]));
  tour = addThing(tour, newMarker(tour, "Door", [1, 2, 3], "stop-1"));
  tour = addThing(tour, newModel(tour, "House", [1, 2, 3], MODEL), { file: MODEL, name: "house.glb", bytes: 5 });
  tour = setPicture(tour, "stop-1", { file: PICTURE, name: "a.jpg", bytes: 7 });
  assert.deepEqual(
    tour.things.map(({ id }) => id),
    ["label-1", "label-2", "marker-1", "model-1"],
  );
  writeTour(tour);
  // A pose of the viewer has more than that of a stop.
  const orthoHeightM = null;
  const stop = newStop(tour, "Five", { ...pose([0, 0, 5]), orthoHeightM } as ReturnType<typeof pose>);
  assert.deepEqual(Object.keys(stop.pose), ["eyeEnu", "rotation", "fovyDeg"]);
});

test("a change that changes nothing gives the same tour", () => {
  const tour = sampleTour();
  const [a] = tour.stops;
  assert.ok(a);
  const unchanged: Tour[] = [
    setTitle(tour, tour.title),
    setStart(tour, "b"),
    setStart(tour, "nowhere"),
    changeStop(tour, "a", { title: "The gate", pose: { ...a.pose, eyeEnu: [...a.pose.eyeEnu] } }),
    changeStop(tour, "nowhere", { title: "x" }),
    moveStop(tour, "a", 0),
    moveStop(tour, "a", -5),
    moveStop(tour, "nowhere", 1),
    removeStop(tour, "nowhere"),
    setNext(tour, "b", { to: "c", path: { kind: "over" } }),
    setNext(tour, "b", { to: "nowhere", path: { kind: "over" } }),
    addBranch(tour, "a", { to: "nowhere", label: "x", path: { kind: "direct" } }),
    changeBranch(tour, "a", 0, { to: "c" }),
    changeBranch(tour, "a", 0, { to: "nowhere" }),
    changeBranch(tour, "a", 5, { label: "x" }),
    moveBranch(tour, "a", 0, 1),
    removeBranch(tour, "a", 1),
    setPicture(tour, "a", { file: PICTURE, name: "gate.jpg", bytes: 1000 }),
    setPicture(tour, "b", null),
    setPicture(tour, "nowhere", { file: `${"f".repeat(64)}.png`, name: "x", bytes: 1 }),
    removeThing(tour, "nowhere"),
    moveThing(tour, "l", [1, 1, 1]),
    renameThing(tour, "m", "Door"),
    scaleThing(tour, "h", 2),
    scaleThing(tour, "h", Number.NaN),
    scaleThing(tour, "l", 3),
    turnThing(tour, "h", 390),
    turnThing(tour, "h", Number.POSITIVE_INFINITY),
    setTarget(tour, "m", "c"),
    setTarget(tour, "m", "nowhere"),
    setTarget(tour, "l", "c"),
    showAtStops(tour, "m", ["a", "b", "a", "nowhere"]),
  ];
  unchanged.forEach((after, i) => {
    assert.equal(after, tour, `case ${i}`);
  });
});

test("a change leaves the old tour alone, and what it is not about stays the same object", () => {
  const tour = sampleTour();
  const before = writeTour(tour);
  const after = changeStop(tour, "a", { title: "Gate", pauseS: 9 });
  assert.equal(writeTour(tour), before);
  assert.deepEqual([after.stops[0]?.title, after.stops[0]?.pauseS], ["Gate", 9]);
  assert.equal(after.stops[1], tour.stops[1]);
  assert.equal(after.things, tour.things);
  const lower = moveThing(tour, "l", [1, 1, 0]);
  assert.deepEqual([thingOf(lower, "l")?.at, lower.stops === tour.stops], [[1, 1, 0], true]);
});

test("a stop that is removed takes along what led to it", () => {
  let tour = sampleTour();
  tour = setNext(tour, "b", { to: "c", path: { kind: "over" } });
  tour = setStart(tour, "c");
  const after = removeStop(tour, "c");
  assert.equal(order(after), "ab");
  assert.equal(after.start, null);
  assert.deepEqual(stopOf(after, "a")?.branches, []);
  assert.deepEqual(stopOf(after, "b")?.next, { to: null, path: { kind: "over" } });
  // The model was shown only there; the marker loses its target; the label stays as it was.
  assert.deepEqual(
    after.things.map(({ id }) => id),
    ["l", "m"],
  );
  assert.equal(after.things[0], tour.things[0]);
  const marker = thingOf(after, "m");
  assert.ok(marker?.kind === "marker" && marker.to === null);
  assert.deepEqual([...after.assets.keys()], [PICTURE]);
  writeTour(after);
  assert.deepEqual(thingOf(removeStop(after, "b"), "m")?.stops, ["a"]);
  const none = ["a", "b", "c"].reduce(removeStop, sampleTour());
  assert.deepEqual([none.stops.length, none.things.map(({ id }) => id), none.assets.size], [0, ["l"], 0]);
  writeTour(none);
});

test("stops and branches are moved, never lost", () => {
  const tour = sampleTour();
  assert.equal(order(moveStop(tour, "a", 2)), "bca");
  assert.equal(order(moveStop(tour, "c", 0)), "cab");
  assert.equal(order(moveStop(tour, "a", 99)), "bca");
  const two = addBranch(tour, "a", { to: "b", label: "Second", path: { kind: "direct" } });
  const labels = (one: Tour) => stopOf(one, "a")?.branches.map(({ label }) => label);
  assert.deepEqual(labels(moveBranch(two, "a", 1, 0)), ["Second", "Up the tower"]);
  assert.deepEqual(labels(removeBranch(two, "a", 0)), ["Second"]);
  assert.deepEqual(labels(changeBranch(two, "a", 1, { label: "2" })), ["Up the tower", "2"]);
});

test("only files that are used stay listed", () => {
  const tour = sampleTour();
  assert.deepEqual([...removeThing(tour, "h").assets.keys()], [PICTURE]);
  assert.deepEqual([...setPicture(tour, "a", null).assets.keys()], [MODEL]);
  const shared = setPicture(tour, "b", { file: PICTURE, name: "gate.jpg", bytes: 1000 });
  assert.deepEqual([...setPicture(shared, "a", null).assets.keys()], [PICTURE, MODEL]);
  assert.throws(() => addThing(EMPTY_TOUR, newModel(EMPTY_TOUR, "House", [0, 0, 0], MODEL)), CheckError);
});

test("models keep to the limits of the format", () => {
  const tour = sampleTour();
  const model = (one: Tour) => {
    const thing = thingOf(one, "h");
    assert.ok(thing?.kind === "model");
    return thing;
  };
  assert.equal(model(scaleThing(tour, "h", 1e9)).scale, 1e4);
  assert.equal(model(scaleThing(tour, "h", 1e-9)).scale, 1e-4);
  assert.equal(model(turnThing(tour, "h", -90)).yawDeg, 270);
  assert.equal(model(renameThing(tour, "h", "Barn")).name, "Barn");
  writeTour(scaleThing(turnThing(tour, "h", 1e6), "h", 3));
});

test("lists that are full say so", () => {
  let tour = sampleTour();
  while (tour.stops.length < 200) tour = addStop(tour, newStop(tour, "x", pose([0, 0, 0])));
  assert.throws(() => addStop(tour, newStop(tour, "x", pose([0, 0, 0]))), /at most 200/);
  const branch = { to: "b", label: "x", path: { kind: "direct" } } as const;
  while ((stopOf(tour, "a")?.branches.length ?? 20) < 20) tour = addBranch(tour, "a", branch);
  assert.throws(() => addBranch(tour, "a", branch), /at most 20/);
  while (tour.things.length < 500) tour = addThing(tour, newLabel(tour, "x", [0, 0, 0]));
  assert.throws(() => addThing(tour, newLabel(tour, "x", [0, 0, 0])), /at most 500/);
});

test("undo by snapshots brings back all that a removal took", () => {
  const history = new History<Tour>();
  const first = sampleTour();
  let tour = first;
  const apply = (label: string, after: Tour) => {
    history.push({ label, before: tour, after, group: null });
    tour = after;
  };
  apply("remove", removeStop(tour, "c"));
  apply("rename", changeStop(tour, "a", { title: "x" }));
  const last = tour;
  history.undo();
  assert.equal(history.undo()?.before, first);
  history.redo();
  assert.equal(history.redo()?.after, last);
});
