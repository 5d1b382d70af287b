import assert from "node:assert/strict";
import test from "node:test";
import type { AppContext } from "../../../../src/panels/context.js";
import { groupCommands } from "../../../../src/panels/shell/command_groups.js";
import { addViewCommands } from "../../../../src/panels/shell/view_commands.js";
import type { DrapedMap } from "../../../../src/state/app_state.js";
import { CommandTable } from "../../../../src/state/commands.js";
import { initialState } from "../../../../src/state/initial.js";
import type { Project } from "../../../../src/state/project.js";
import { Store } from "../../../../src/state/store.js";
import { addToolCommands } from "../../../../src/tools/tool_commands.js";

const TRUST: DrapedMap = { url: "/data/pictures/2.png", min: [0, 0], max: [1, 1], scale: 0.25 };

function application() {
  // Commands need little of them; what is missing would fail loudly.
  const project = { name: "p", groundM: 0, min: [0, 0, 0], max: [1, 1, 1] } as unknown as Project;
  const store = new Store(initialState(project));
  const commands = new CommandTable();
  const asked: string[] = [];
  const link = {
    errorMap: () => {
      asked.push("errorMap");
      return Promise.reject(new Error("no held-out photos"));
    },
    trustMap: () => {
      asked.push("trust");
      return Promise.resolve(TRUST);
    },
  };
  const context = { project, store, commands, scene: {}, link } as unknown as AppContext;
  addToolCommands(context, () => {
    throw new Error("no tool");
  });
  addViewCommands(context);
  return { store, commands, asked };
}

test("no two commands have the same key, and the help lists all", () => {
  const { commands } = application();
  assert.deepEqual(commands.conflicts(), []);
  const listed = groupCommands(commands.all()).flatMap((group) => group.commands);
  assert.equal(listed.length, commands.all().length);
});

test("keys of the view open and close panels and layers, but not behind a dialog", () => {
  const { store, commands } = application();
  const press = (key: string) => commands.handleKey({ key, ctrl: false, shift: false, alt: false });
  assert.ok(press("l"));
  assert.equal(store.get().panel, null);
  assert.ok(press("b"));
  assert.equal(store.get().layers.blocks, true);
  store.set({ help: true });
  assert.equal(press("b"), false);
  assert.ok(press("?"));
  assert.equal(store.get().help, false);
});

test("the error map is asked for once; without an answer the layer goes off again and the reason is told", async () => {
  const { store, commands, asked } = application();
  await commands.run("layer.errorMap");
  assert.deepEqual(asked, ["errorMap"]);
  assert.equal(store.get().layers.errorMap, false);
  assert.match(store.get().notices[0]?.text ?? "", /no held-out photos/);
});

test("of the maps of errors one is on at a time, and one that has been made is not asked for again", async () => {
  const { store, commands, asked } = application();
  const on = () => [store.get().layers.errorMap, store.get().layers.trust];
  const failing = commands.run("layer.errorMap");
  assert.deepEqual(on(), [true, false]);
  const made = commands.run("layer.trust");
  assert.deepEqual(on(), [false, true]);
  await Promise.all([failing, made]);
  assert.deepEqual(on(), [false, true], "the other one's failure does not switch it off");
  assert.equal(store.get().trust, TRUST);
  await commands.run("layer.trust");
  assert.deepEqual(on(), [false, false]);
  await commands.run("layer.trust");
  assert.deepEqual(on(), [false, true]);
  assert.deepEqual(asked, ["errorMap", "trust"]);
});

test("commands are grouped by their ids and none is lost", () => {
  const command = (id: string) => ({ id, label: id, keys: [], when: () => true, run: () => {} });
  const groups = groupCommands(["tool.point", "view.all", "navigation.fly", "odd"].map(command));
  assert.deepEqual(
    groups.map(({ title, commands }) => [title, commands.map(({ id }) => id)]),
    [
      ["View", ["view.all", "navigation.fly"]],
      ["Tools", ["tool.point"]],
      ["More", ["odd"]],
    ],
  );
});
