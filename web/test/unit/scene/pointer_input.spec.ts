import assert from "node:assert/strict";
import test from "node:test";
import { type Gestures, PointerInput } from "../../../src/scene/pointer_input.js";

class Canvas extends EventTarget {
  focus(): void {}
  setPointerCapture(): void {}
  getBoundingClientRect(): { left: number; top: number } {
    return { left: 0, top: 0 };
  }
  fire(type: string, x: number, more: object): void {
    const fields = { pointerId: 1, button: 0, buttons: 1, pointerType: "mouse", clientX: x, clientY: 0 };
    this.dispatchEvent(Object.assign(new Event(type), fields, more));
  }
}

test("a mouse whose button was released outside drags no longer", () => {
  const canvas = new Canvas();
  const told: string[] = [];
  const gestures: Gestures = {
    touched: () => {},
    begin: () => told.push("begin"),
    move: () => told.push("move"),
    end: () => told.push("end"),
    pinch: () => told.push("pinch"),
    wheel: () => {},
  };
  const input = new PointerInput(canvas as unknown as HTMLCanvasElement, gestures);
  canvas.fire("pointerdown", 0, {});
  canvas.fire("pointermove", 2, {});
  canvas.fire("pointermove", 80, { buttons: 0 });
  assert.deepEqual(told, []);
  canvas.fire("pointerdown", 0, {});
  canvas.fire("pointermove", 20, {});
  canvas.fire("pointermove", 40, { buttons: 0 });
  canvas.fire("pointermove", 60, { buttons: 0 });
  assert.deepEqual(told, ["begin", "move", "end"]);
  input.dispose();
});
