// The other tools, commands, the cursor's coordinates.
import assert from "node:assert/strict";
import test from "node:test";
import { mapFromEnu } from "../../../src/geo/projection.js";
import { addViewCommands } from "../../../src/panels/shell/view_commands.js";
import { newArea, newDistance, withMeasurement } from "../../../src/state/measurements.js";
import { measurementAt } from "../../../src/tools/navigate_tool.js";
import { createTools } from "../../../src/tools/tools.js";
import { NO_ACCURACY, samplePoint, sampleProject } from "../state/samples.js";
import { type Bench, bench, FakeFiles, hitAt, settle } from "./fakes.js";

function start(b: Bench): { dispose(): void } {
  return createTools({ ...b, files: new FakeFiles(), page: b.page as unknown as Window });
}

function click(b: Bench, x: number, y: number, more: Record<string, unknown> = {}): void {
  b.clock.advance(1000);
  b.canvas.click([x, y], more);
}

async function answerNewest(b: Bench): Promise<void> {
  await settle();
  const pick = b.engine.picks[b.engine.picks.length - 1];
  const [x, y] = pick?.asked.ray.originEnu ?? [0, 0];
  pick?.resolve(hitAt(x, y));
  await settle();
}

test("no two commands of tools and panels share a key, and each has an id of a known group", () => {
  const b = bench();
  start(b);
  addViewCommands(b);
  assert.deepEqual(b.commands.conflicts(), []);
  for (const { id } of b.commands.all())
    assert.match(id, /^(tool|navigation|draft|edit|path|view|panel|layer|tour|play)\.[a-zA-Z]+$/);
  for (const id of [
    "tool.navigate",
    "tool.control",
    "edit.undo",
    "edit.redo",
    "edit.delete",
    "navigation.top",
    "path.add",
  ]) {
    assert.notEqual(b.commands.get(id), null, id);
  }
});

test("the coordinates under the cursor follow the pointer and go when it leaves", async () => {
  const b = bench();
  const tools = start(b);
  await settle();
  b.canvas.fire("pointermove", [30, 40]);
  b.clock.advance(200);
  assert.deepEqual(b.store.get().readout.cursor?.enu, [30, -40, 0]);
  const before = b.picked;
  // The camera has moved below the pointer.
  b.store.update(({ readout }) => ({ readout: { ...readout, headingDeg: 45 } }));
  b.clock.advance(200);
  assert.equal(b.picked, before + 1);
  b.store.set({ tool: "distance" });
  click(b, 30, 40);
  b.canvas.fire("pointermove", [50, 40]);
  b.clock.advance(200);
  assert.deepEqual(b.store.get().hover?.enu, [50, -40, 0]);
  b.canvas.fire("pointerleave", [900, 0]);
  assert.equal(b.store.get().readout.cursor, null);
  assert.equal(b.store.get().hover, null);
  tools.dispose();
  b.canvas.fire("pointermove", [30, 40]);
  b.clock.advance(1000);
  assert.equal(b.store.get().readout.cursor, null);
  assert.equal(b.commands.all().length, 0);
});

test("the photos tool asks with the field's point, and only the newest click counts", async () => {
  const b = bench();
  start(b);
  await settle();
  b.store.set({ tool: "photos" });
  click(b, 10, 10);
  await answerNewest(b);
  click(b, 20, 20);
  assert.equal(b.store.get().draft.length, 1);
  await answerNewest(b);
  assert.deepEqual(
    b.engine.sights.map(({ asked }) => asked),
    [
      [10, -10, 0.5],
      [20, -20, 0.5],
    ],
  );
  b.engine.sights[1]?.resolve({ checked: true, photos: [] });
  await settle();
  b.engine.sights[0]?.resolve({ checked: false, photos: [] });
  await settle();
  const { sights, panel } = b.store.get();
  assert.equal(sights?.checked, true);
  assert.equal(sights.point.source, "field");
  assert.equal(panel, "photos");
  click(b, 30, 30);
  await answerNewest(b);
  b.engine.sights[2]?.reject(new Error("not connected"));
  await settle();
  assert.match(b.store.get().notices[0]?.text ?? "", /not connected/);
});

test("the control tool places in map coordinates, corrects the selected point, and adds with Shift", async () => {
  const project = sampleProject();
  const b = bench({ georeferenced: true, crs: project.crs });
  start(b);
  await settle();
  b.store.set({ tool: "control" });
  click(b, 10, 10);
  await answerNewest(b);
  const points = () => b.store.get().documents.controlPoints;
  assert.deepEqual(
    points().map(({ name }) => name),
    ["GCP 1"],
  );
  assert.deepEqual(points()[0]?.xyz, mapFromEnu(b.project, [10, -10, 0.5]));
  assert.equal(b.store.get().selectedControl, "GCP 1");
  click(b, 30, 10);
  await answerNewest(b);
  assert.deepEqual(points()[0]?.xyz, mapFromEnu(b.project, [30, -10, 0.5]));
  click(b, 50, 10, { shiftKey: true });
  await answerNewest(b);
  assert.deepEqual(
    points().map(({ name }) => name),
    ["GCP 1", "GCP 2"],
  );
  assert.equal(b.store.undo(), "add control point");
  assert.equal(b.store.undo(), "move control point");
  assert.deepEqual(points()[0]?.xyz, mapFromEnu(b.project, [10, -10, 0.5]));
  assert.equal(b.store.undo(), "add control point");
  assert.equal(points().length, 0);
});

test("a click on a building selects it and opens its panel; undo has nothing to do with it", async () => {
  const b = bench();
  const tools = start(b);
  addViewCommands(b);
  await settle();
  b.buildings.set("30,40", 7);
  click(b, 30, 40);
  assert.equal(b.store.get().selectedBuilding, null, "they are not shown");
  b.store.update(({ layers }) => ({ layers: { ...layers, buildings: true } }));
  b.canvas.fire("pointermove", [30, 40]);
  b.clock.advance(200);
  assert.equal(b.store.get().hoverBuilding, 7);
  click(b, 30, 40);
  assert.equal(b.store.get().selectedBuilding, 7);
  assert.equal(b.store.get().panel, "buildings");
  b.page.key("z", { ctrlKey: true });
  assert.equal(b.store.get().selectedBuilding, 7);
  assert.equal(b.store.get().save, "saved");
  b.page.key("Escape");
  assert.equal(b.store.get().selectedBuilding, null);
  click(b, 30, 40);
  click(b, 200, 200);
  assert.equal(b.store.get().selectedBuilding, null, "a click beside it");
  b.canvas.fire("pointermove", [30, 40]);
  b.clock.advance(200);
  b.canvas.fire("pointerleave", [0, 0]);
  assert.equal(b.store.get().hoverBuilding, null);
  b.canvas.fire("pointermove", [30, 40]);
  b.clock.advance(200);
  b.store.set({ tool: "distance" });
  assert.equal(b.store.get().hoverBuilding, null, "other tools do not point at buildings");
  b.store.set({ tool: "navigate" });
  // A measurement that lies on the building is nearer to the person's mind.
  b.store.changeDocuments("add", (documents) =>
    withMeasurement(
      documents,
      newDistance(documents, [samplePoint([30, -40, 0]), samplePoint([60, -40, 0])], sampleProject()),
    ),
  );
  click(b, 30, 40);
  assert.equal(b.store.get().selectedBuilding, null);
  assert.notEqual(b.store.get().selected, null);
  tools.dispose();
});

test("a click on a measurement selects it, Delete deletes it", async () => {
  const b = bench();
  start(b);
  await settle();
  b.store.changeDocuments("add", (documents) =>
    withMeasurement(
      documents,
      newDistance(documents, [samplePoint([100, -100, 0]), samplePoint([200, -100, 0])], sampleProject()),
    ),
  );
  click(b, 150, 105);
  assert.equal(b.store.get().selected, "m1");
  click(b, 150, 150);
  assert.equal(b.store.get().selected, null);
  assert.equal(b.page.key("Delete").defaultPrevented, false);
  click(b, 203, 100);
  b.page.key("Delete");
  assert.equal(b.store.get().documents.measurements.length, 0);
  assert.equal(b.store.get().selected, null);
});

test("the nearest measurement is taken, outlines are closed, what is behind the camera is left out", () => {
  const { documents } = bench().store.get();
  const corners = [
    [0, 0, 0],
    [100, 0, 0],
    [100, -100, 0],
  ] as const;
  const area = {
    ...newArea(
      documents,
      corners.map((enu) => samplePoint(enu)),
      NO_ACCURACY,
    ),
    id: "area",
  };
  const line = {
    ...newDistance(
      documents,
      corners.map((enu) => samplePoint([enu[0], enu[1] + 6, 0])),
      sampleProject(),
    ),
    id: "line",
  };
  const flat = (point: readonly [number, number, number]) => [point[0], -point[1]] as const;
  assert.equal(measurementAt([line, area], [50, -1], flat), "area");
  assert.equal(measurementAt([line, area], [50, -5], flat), "line");
  // The side that closes the outline.
  assert.equal(measurementAt([area], [50, 50], flat), "area");
  assert.equal(measurementAt([line], [50, 44], flat), null);
  assert.equal(
    measurementAt([area], [50, 50], () => null),
    null,
  );
});

test("a key frame takes the view, from straight above as a perspective one", async () => {
  const b = bench();
  start(b);
  await settle();
  b.page.key("k");
  b.pose = { ...b.pose, orthoHeightM: 50 };
  b.page.key("k");
  const { keys } = b.store.get().documents.cameraPath;
  assert.deepEqual(
    keys.map(({ name }) => name),
    ["Key 1", "Key 2"],
  );
  assert.deepEqual(keys[0]?.pose.eyeEnu, [0, 0, 100]);
  assert.equal(keys[1]?.pose.orthoHeightM, null);
});

test("keys do nothing behind a dialog", async () => {
  const b = bench();
  start(b);
  await settle();
  b.store.set({ help: true });
  b.page.key("3");
  b.page.key("k");
  assert.equal(b.store.get().tool, "navigate");
  assert.equal(b.store.get().documents.cameraPath.keys.length, 0);
});
