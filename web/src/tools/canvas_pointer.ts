// Pointer events of the canvas as clicks, double clicks and hovering. Drags are the camera's.
import type { Clock } from "../base/clock.js";
import { Disposer } from "../base/disposer.js";
import type { Vec2 } from "../base/vec.js";
import type { ToolPointer } from "./tool.js";

export interface PointerUser {
  click(pointer: ToolPointer): void;
  doubleClick(pointer: ToolPointer): void;
  /** Null: the pointer has left. At most 10 calls a second. */
  hover(pointer: ToolPointer | null): void;
}

const CLICK_PX = 4;
const DOUBLE_PX = 6;
const DOUBLE_MS = 400;
const HOVER_MS = 100;

export class CanvasPointer {
  private readonly canvas: HTMLCanvasElement;
  private readonly user: PointerUser;
  private readonly clock: Clock;
  private readonly disposer = new Disposer();
  private readonly down = new Set<number>();
  private press: { readonly id: number; readonly px: Vec2 } | null = null;
  private lastClick: { readonly px: Vec2; readonly atMs: number } | null = null;
  /** Where the pointer hovers; null: elsewhere, or it drags. */
  private over: ToolPointer | null = null;
  private lastHoverMs = Number.NEGATIVE_INFINITY;
  private cancelHover: (() => void) | null = null;

  constructor(canvas: HTMLCanvasElement, user: PointerUser, clock: Clock) {
    this.canvas = canvas;
    this.user = user;
    this.clock = clock;
    const d = this.disposer;
    d.listen(canvas, "pointerdown", (event: PointerEvent) => this.onDown(event));
    d.listen(canvas, "pointermove", (event: PointerEvent) => this.onMove(event));
    d.listen(canvas, "pointerup", (event: PointerEvent) => this.onUp(event));
    d.listen(canvas, "pointercancel", (event: PointerEvent) => this.onCancel(event));
    d.listen(canvas, "pointerleave", () => this.onLeave());
  }

  /** The view has changed under the pointer. */
  refresh(): void {
    if (this.over !== null) this.wantHover();
  }

  dispose(): void {
    this.disposer.dispose();
    this.cancelHover?.();
    this.cancelHover = null;
  }

  private pointer(event: PointerEvent): ToolPointer {
    const box = this.canvas.getBoundingClientRect();
    return {
      px: [event.clientX - box.left, event.clientY - box.top],
      shift: event.shiftKey,
      ctrl: event.ctrlKey || event.metaKey,
    };
  }

  private onDown(event: PointerEvent): void {
    this.down.add(event.pointerId);
    // A second finger or button makes it a gesture.
    this.press =
      event.button === 0 && this.down.size === 1 ? { id: event.pointerId, px: this.pointer(event).px } : null;
    this.over = null;
  }

  private onMove(event: PointerEvent): void {
    const pointer = this.pointer(event);
    if (this.press !== null && apart(this.press.px, pointer.px) > CLICK_PX) this.press = null;
    if (event.buttons !== 0 || event.pointerType === "touch") return;
    // A button that was released outside is not heard of.
    this.down.clear();
    this.over = pointer;
    this.wantHover();
  }

  private onUp(event: PointerEvent): void {
    this.down.delete(event.pointerId);
    const press = this.press;
    this.press = null;
    const pointer = this.pointer(event);
    if (
      press !== null &&
      press.id === event.pointerId &&
      event.button === 0 &&
      apart(press.px, pointer.px) <= CLICK_PX
    ) {
      this.clicked(pointer);
    }
    if (event.pointerType === "touch") return;
    this.over = pointer;
    this.wantHover();
  }

  private onCancel(event: PointerEvent): void {
    this.down.delete(event.pointerId);
    this.press = null;
  }

  private onLeave(): void {
    this.over = null;
    this.cancelHover?.();
    this.cancelHover = null;
    this.user.hover(null);
  }

  private clicked(pointer: ToolPointer): void {
    const nowMs = this.clock.nowMs();
    const last = this.lastClick;
    if (last !== null && nowMs - last.atMs <= DOUBLE_MS && apart(last.px, pointer.px) <= DOUBLE_PX) {
      // A third click begins anew.
      this.lastClick = null;
      this.user.doubleClick(pointer);
      return;
    }
    this.lastClick = { px: pointer.px, atMs: nowMs };
    this.user.click(pointer);
  }

  private wantHover(): void {
    if (this.cancelHover !== null) return;
    const waitMs = Math.max(0, this.lastHoverMs + HOVER_MS - this.clock.nowMs());
    this.cancelHover = this.clock.after(waitMs, () => {
      this.cancelHover = null;
      if (this.over === null) return;
      this.lastHoverMs = this.clock.nowMs();
      this.user.hover(this.over);
    });
  }
}

function apart(a: Vec2, b: Vec2): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}
