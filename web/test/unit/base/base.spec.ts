import assert from "node:assert/strict";
import test from "node:test";
import { AbortError, errorText, isAbort } from "../../../src/base/abort.js";
import { ManualClock } from "../../../src/base/clock.js";
import { Disposer } from "../../../src/base/disposer.js";
import { Emitter } from "../../../src/base/emitter.js";

test("a disposer ends the newest first, once, and all in spite of an error", () => {
  const ended: string[] = [];
  const disposer = new Disposer();
  disposer.add(() => ended.push("first"));
  const owned = disposer.own({ dispose: () => ended.push("second") });
  disposer.add(() => {
    throw new Error("third");
  });
  assert.ok(owned);
  assert.throws(() => disposer.dispose(), /third/);
  assert.deepEqual(ended, ["second", "first"]);
  disposer.dispose();
  assert.equal(ended.length, 2);
  disposer.add(() => ended.push("late"));
  assert.deepEqual(ended, ["second", "first", "late"]);
});

test("listeners of a disposer are removed with what they were added with", () => {
  const target = new EventTarget();
  const disposer = new Disposer();
  let heard = 0;
  disposer.listen(
    target,
    "ping",
    (_: Event) => {
      heard += 1;
    },
    { capture: true },
  );
  target.dispatchEvent(new Event("ping"));
  disposer.dispose();
  target.dispatchEvent(new Event("ping"));
  disposer.listen(target, "ping", (_: Event) => assert.fail("listens after the end"));
  target.dispatchEvent(new Event("ping"));
  assert.equal(heard, 1);
});

test("an emitter tells all in spite of an error, and nobody who left", () => {
  const emitter = new Emitter<[number]>();
  const heard: string[] = [];
  emitter.on(() => {
    endLast();
    throw new Error("broken");
  });
  emitter.on((value) => heard.push(`b${value}`));
  const endLast = emitter.on((value) => heard.push(`c${value}`));
  assert.throws(() => emitter.emit(1), /broken/);
  assert.deepEqual(heard, ["b1"]);
});

test("one function registered twice is called twice and ends once", () => {
  const emitter = new Emitter<[]>();
  let heard = 0;
  const listener = () => {
    heard += 1;
  };
  emitter.on(listener);
  const end = emitter.on(listener);
  emitter.emit();
  end();
  end();
  emitter.emit();
  assert.equal(heard, 3);
});

test("the manual clock runs timers in order, also those set meanwhile", () => {
  const clock = new ManualClock();
  const ran: string[] = [];
  clock.after(20, () => ran.push(`b${clock.nowMs()}`));
  clock.after(10, () => {
    ran.push(`a${clock.nowMs()}`);
    clock.after(5, () => ran.push(`a2 ${clock.nowMs()}`));
  });
  const cancel = clock.after(15, () => assert.fail("was cancelled"));
  cancel();
  clock.advance(19);
  assert.deepEqual(ran, ["a10", "a2 15"]);
  clock.advance(1);
  assert.deepEqual(ran, ["a10", "a2 15", "b20"]);
  assert.equal(clock.waiting, 0);
});

test("abort errors are recognised, also the browser's", () => {
  assert.ok(isAbort(new AbortError()));
  assert.ok(isAbort(new DOMException("x", "AbortError")));
  for (const other of [new Error("x"), null, "AbortError", undefined]) assert.ok(!isAbort(other));
  assert.equal(errorText(new Error("why")), "why");
  assert.equal(errorText("why"), "why");
});
