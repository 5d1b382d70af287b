import assert from "node:assert/strict";
import test from "node:test";
import { CommandTable } from "../../../src/state/commands.js";
import { type FocusedElement, keepsKey, listenToCommandKeys } from "../../../src/tools/keyboard.js";
import { FakePage } from "./fakes.js";

const element = (tagName: string, more: Partial<FocusedElement> = {}): FocusedElement => ({ tagName, ...more });

test("what has the focus keeps the keys that it needs", () => {
  assert.equal(keepsKey(null, "k"), false);
  assert.equal(keepsKey(element("CANVAS"), "Enter"), false);
  assert.equal(keepsKey(element("INPUT", { type: "text" }), "k"), true);
  assert.equal(keepsKey(element("INPUT"), "k"), true);
  assert.equal(keepsKey(element("INPUT", { type: "checkbox" }), "k"), false);
  assert.equal(keepsKey(element("INPUT", { type: "range" }), "Home"), true);
  assert.equal(keepsKey(element("SELECT"), "k"), true);
  assert.equal(keepsKey(element("TEXTAREA"), "Escape"), true);
  assert.equal(keepsKey(element("BUTTON"), "Enter"), true);
  assert.equal(keepsKey(element("BUTTON"), "Escape"), false);
  assert.equal(keepsKey(element("DIV", { isContentEditable: true }), "k"), true);
  assert.equal(
    keepsKey(element("BUTTON", { closest: (selector) => (selector === "dialog[open]" ? {} : null) }), "k"),
    true,
  );
});

test("keys become commands, and only those are kept from the browser", () => {
  const commands = new CommandTable();
  let count = 0;
  commands.add({
    id: "a",
    label: "a",
    keys: ["k", "Ctrl+Z", "Backspace"],
    when: () => true,
    run: () => {
      count += 1;
    },
  });
  const page = new FakePage();
  const end = listenToCommandKeys(page as unknown as Window, commands);
  assert.equal(page.key("k").defaultPrevented, true);
  assert.equal(page.key("j").defaultPrevented, false);
  assert.equal(page.key("z", { metaKey: true }).defaultPrevented, true);
  assert.equal(count, 2);
  // Held down: undo goes on, a key frame is added once.
  page.key("k", { repeat: true });
  page.key("z", { ctrlKey: true, repeat: true });
  page.key("Backspace", { repeat: true });
  assert.equal(count, 4);
  page.key("k", { isComposing: true });
  // AltGr looks like Ctrl and Alt.
  page.key("k", { ctrlKey: true, altKey: true });
  assert.equal(count, 4);
  page.key("k", { ctrlKey: true, altKey: true, getModifierState: (name: string) => name === "AltGraph" });
  assert.equal(count, 5);
  end.dispose();
  page.key("k");
  assert.equal(count, 5);
});
