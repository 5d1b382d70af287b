import assert from "node:assert/strict";
import test from "node:test";
import { ManualClock } from "../../../src/base/clock.js";
import { CanvasPointer } from "../../../src/tools/canvas_pointer.js";
import { FakeCanvas } from "./fakes.js";

function listen() {
  const canvas = new FakeCanvas();
  const clock = new ManualClock();
  const log: string[] = [];
  const pointer = new CanvasPointer(
    canvas as unknown as HTMLCanvasElement,
    {
      click: ({ px, shift, ctrl }) => log.push(`click ${px}${shift ? " shift" : ""}${ctrl ? " ctrl" : ""}`),
      doubleClick: ({ px }) => log.push(`double ${px}`),
      hover: (at) => log.push(at === null ? "left" : `hover ${at.px}`),
    },
    clock,
  );
  const clicks = () => log.filter((line) => !line.startsWith("hover"));
  return { canvas, clock, log, clicks, pointer };
}

test("a click is pressed and released within 4 pixels, by one finger, with the left button", () => {
  const { canvas, clicks } = listen();
  canvas.click([30, 40], { shiftKey: true, metaKey: true });
  canvas.fire("pointerdown", [100, 100], { buttons: 1 });
  canvas.fire("pointermove", [105, 100], { buttons: 1 });
  // Back at its start it is still a drag.
  canvas.fire("pointermove", [100, 100], { buttons: 1 });
  canvas.fire("pointerup", [100, 100]);
  canvas.click([200, 200], { button: 2 });
  canvas.fire("pointerdown", [300, 300], { pointerType: "touch" });
  canvas.fire("pointerdown", [350, 300], { pointerType: "touch", pointerId: 2 });
  canvas.fire("pointerup", [300, 300], { pointerType: "touch" });
  canvas.fire("pointerup", [350, 300], { pointerType: "touch", pointerId: 2 });
  canvas.fire("pointerdown", [400, 400], { pointerType: "touch" });
  canvas.fire("pointercancel", [400, 400], { pointerType: "touch" });
  canvas.fire("pointerup", [400, 400], { pointerType: "touch" });
  assert.deepEqual(clicks(), ["click 30,40 shift ctrl"]);
  canvas.click([3, 4], { pointerType: "touch" });
  assert.equal(clicks().length, 2);
});

test("two quick clicks at one place are a click and a double click, a third begins anew", () => {
  const { canvas, clock, clicks } = listen();
  canvas.click([10, 10]);
  clock.advance(200);
  canvas.click([12, 10]);
  clock.advance(100);
  canvas.click([12, 10]);
  clock.advance(401);
  canvas.click([12, 10]);
  clock.advance(100);
  canvas.click([30, 10]);
  assert.deepEqual(clicks(), ["click 10,10", "double 12,10", "click 12,10", "click 12,10", "click 30,10"]);
});

test("hovering is told 10 times a second, the last place too, and not while dragging or elsewhere", () => {
  const { canvas, clock, log, pointer } = listen();
  for (let i = 0; i < 100; i += 1) {
    canvas.fire("pointermove", [i, 0]);
    clock.advance(10);
  }
  clock.advance(100);
  assert.ok(log.length >= 10 && log.length <= 12, String(log.length));
  assert.equal(log[log.length - 1], "hover 99,0");
  log.length = 0;
  canvas.fire("pointerdown", [0, 0], { buttons: 1 });
  canvas.fire("pointermove", [50, 0], { buttons: 1 });
  pointer.refresh();
  clock.advance(1000);
  assert.deepEqual(log, []);
  canvas.fire("pointerup", [50, 0]);
  clock.advance(1000);
  assert.deepEqual(log, ["hover 50,0"]);
  pointer.refresh();
  clock.advance(1000);
  assert.equal(log.length, 2);
  canvas.fire("pointermove", [60, 0]);
  canvas.fire("pointerleave", [900, 0]);
  pointer.refresh();
  clock.advance(1000);
  assert.deepEqual(log.slice(2), ["left"]);
  pointer.dispose();
  canvas.fire("pointermove", [60, 0]);
  assert.equal(clock.waiting, 0);
});
