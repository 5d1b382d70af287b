import assert from "node:assert/strict";
import test from "node:test";
import { type Command, CommandTable, canonicalKey, canonicalKeyOfText } from "../../../src/state/commands.js";
import { initialState } from "../../../src/state/initial.js";
import { sampleProject } from "./samples.js";

const PLAIN = { ctrl: false, shift: false, alt: false };

function command(
  id: string,
  keys: string[],
  run: () => void | Promise<void> = () => {},
  when: Command["when"] = () => true,
): Command {
  return { id, label: id, keys, when, run };
}

test("keys of texts and events meet", () => {
  const pairs: [string, Parameters<typeof canonicalKey>[0]][] = [
    ["k", { ...PLAIN, key: "k" }],
    // Caps lock.
    ["k", { ...PLAIN, key: "K" }],
    ["Ctrl+Z", { ...PLAIN, key: "z", ctrl: true }],
    ["Ctrl+Shift+Z", { ...PLAIN, key: "Z", ctrl: true, shift: true }],
    ["?", { ...PLAIN, key: "?", shift: true }],
    ["1", { ...PLAIN, key: "1", shift: true }],
    ["Home", { ...PLAIN, key: "Home" }],
    ["Ctrl++", { ...PLAIN, key: "+", ctrl: true, shift: true }],
    ["+", { ...PLAIN, key: "+" }],
  ];
  for (const [text, press] of pairs) assert.equal(canonicalKeyOfText(text), canonicalKey(press), text);
  assert.notEqual(canonicalKeyOfText("Ctrl+Z"), canonicalKeyOfText("Ctrl+Shift+Z"));
  assert.notEqual(canonicalKeyOfText("Home"), canonicalKeyOfText("Shift+Home"));
  assert.throws(() => canonicalKeyOfText("Hyper+Z"), /is not a key/);
  assert.throws(() => canonicalKeyOfText(""), /is not a key/);
});

test("a key runs its command when it may, and is somebody else's otherwise", () => {
  const table = new CommandTable();
  let allowed = true;
  let count = 0;
  table.add(
    command(
      "a.one",
      ["x"],
      () => {
        count += 1;
      },
      () => allowed,
    ),
  );
  table.attach({ state: () => initialState(sampleProject()), onError: () => assert.fail() });
  assert.equal(table.handleKey({ ...PLAIN, key: "x" }), true);
  assert.equal(table.handleKey({ ...PLAIN, key: "x", ctrl: true }), false);
  assert.equal(table.handleKey({ ...PLAIN, key: "y" }), false);
  allowed = false;
  assert.equal(table.handleKey({ ...PLAIN, key: "x" }), false);
  assert.equal(table.enabled("a.one"), false);
  assert.equal(count, 1);
});

test("errors of commands, thrown or rejected, are told and thrown no further", async () => {
  const table = new CommandTable();
  const told: string[] = [];
  table.add(
    command("a.throws", ["x"], () => {
      throw new Error("at once");
    }),
  );
  table.add(command("a.rejects", [], () => Promise.reject(new Error("later"))));
  table.attach({
    state: () => initialState(sampleProject()),
    onError: (failed, error) => told.push(`${failed.id}: ${error instanceof Error ? error.message : ""}`),
  });
  table.handleKey({ ...PLAIN, key: "x" });
  await table.run("a.rejects");
  assert.deepEqual(told, ["a.throws: at once", "a.rejects: later"]);
  await assert.rejects(table.run("a.none"), /no command/);
});

test("ids are unique, keys with two commands are found, what is taken out is gone", () => {
  const table = new CommandTable();
  const end = table.add(command("a.one", ["x", "Ctrl+X"]));
  assert.throws(() => table.add(command("a.one", [])), /two commands/);
  table.add(command("a.two", ["X"]));
  assert.deepEqual(table.conflicts(), ["x"]);
  end();
  end();
  assert.deepEqual(table.conflicts(), []);
  assert.equal(table.get("a.one"), null);
  assert.equal(table.handleKey({ ...PLAIN, key: "x", ctrl: true }), false);
});
