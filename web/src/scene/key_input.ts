// Keys that move the camera while the canvas has the focus. A short press counts as a tenth of a second, so that it moves something even when it is
// over before the next frame.
import { Disposer } from "../base/disposer.js";
import type { Navigation } from "../state/app_state.js";

export type MoveKey =
  | "left"
  | "right"
  | "up"
  | "down"
  | "ahead"
  | "back"
  | "aside-left"
  | "aside-right"
  | "rise"
  | "sink"
  | "in"
  | "out";

const LEAST_PRESS_MS = 100;

const ARROWS: Readonly<Record<string, MoveKey>> = {
  ArrowLeft: "left",
  ArrowRight: "right",
  ArrowUp: "up",
  ArrowDown: "down",
};
/** By place on the keyboard, whatever letter is printed there. */
const FLY: Readonly<Record<string, MoveKey>> = {
  KeyW: "ahead",
  KeyS: "back",
  KeyA: "aside-left",
  KeyD: "aside-right",
  KeyE: "rise",
  KeyQ: "sink",
  PageUp: "rise",
  PageDown: "sink",
};

interface KeyPress {
  readonly key: string;
  readonly code: string;
}

/** What a key does in this mode; null: nothing. */
export function moveOfKey(press: KeyPress, mode: Navigation): MoveKey | null {
  if (press.key === "+" || press.key === "=" || press.code === "NumpadAdd") return "in";
  if (press.key === "-" || press.key === "_" || press.code === "NumpadSubtract") return "out";
  return ARROWS[press.code] ?? (mode === "fly" ? FLY[press.code] : undefined) ?? null;
}

export interface HeldKey {
  readonly move: MoveKey;
  readonly shift: boolean;
  /** Time for which it counts in this step. */
  readonly ms: number;
}

interface Press {
  readonly move: MoveKey;
  appliedMs: number;
  released: boolean;
}

/** Which keys are down, as time to act on. Pure: events and time come from outside. */
export class HeldKeys {
  private readonly presses = new Map<string, Press>();
  private shift = false;

  get active(): boolean {
    return this.presses.size > 0;
  }

  setShift(shift: boolean): void {
    this.shift = shift;
  }

  down(code: string, move: MoveKey): void {
    const press = this.presses.get(code);
    if (press === undefined) this.presses.set(code, { move, appliedMs: 0, released: false });
    else press.released = false;
  }

  up(code: string): void {
    const press = this.presses.get(code);
    if (press !== undefined) press.released = true;
  }

  clear(): void {
    this.presses.clear();
  }

  step(dtMs: number): HeldKey[] {
    const held: HeldKey[] = [];
    for (const [code, press] of this.presses) {
      const ms = press.released ? Math.min(dtMs, Math.max(0, LEAST_PRESS_MS - press.appliedMs)) : dtMs;
      press.appliedMs += ms;
      if (ms > 0) held.push({ move: press.move, shift: this.shift, ms });
      if (press.released && press.appliedMs >= LEAST_PRESS_MS) this.presses.delete(code);
    }
    return held;
  }
}

/** Listens to the canvas; keys that are used are marked by preventDefault(). */
export function listenToKeys(
  canvas: HTMLCanvasElement,
  held: HeldKeys,
  mode: () => Navigation,
  onKey: () => void,
): Disposer {
  const disposer = new Disposer();
  disposer.listen(canvas, "keydown", (event: KeyboardEvent) => {
    held.setShift(event.shiftKey);
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const move = moveOfKey(event, mode());
    if (move === null) return;
    event.preventDefault();
    held.down(event.code, move);
    onKey();
  });
  disposer.listen(canvas, "keyup", (event: KeyboardEvent) => {
    held.setShift(event.shiftKey);
    held.up(event.code);
  });
  // The release of a key is not heard elsewhere.
  disposer.listen(canvas, "blur", () => held.clear());
  disposer.add(() => held.clear());
  return disposer;
}
