// Mouse, pen, touch and wheel on the canvas as gestures. What is shorter than 4 pixels is a click and belongs to the tools.
import { Disposer } from "../base/disposer.js";
import type { Vec2 } from "../base/vec.js";

export interface Gestures {
  /** A button or finger went down: whatever moves by itself stops. */
  touched(): void;
  /** A drag begins where the button went down. Secondary: right or middle button, or with Ctrl or Command. */
  begin(kind: "primary" | "secondary", px: Vec2): void;
  move(px: Vec2, byPx: Vec2): void;
  /** Velocity at the end, pixels per millisecond. */
  end(velocity: Vec2): void;
  /** Two fingers: distance by `factor` larger, turned clockwise, middle moved. */
  pinch(middlePx: Vec2, factor: number, turnDeg: number, byPx: Vec2): void;
  /** Above 1: away. */
  wheel(px: Vec2, factor: number): void;
}

const CLICK_PX = 4;
const WHEEL_RATE = 0.0016;
const PINCH_RATE = 0.01;
const LARGEST_WHEEL_PX = 240;
const VELOCITY_MS = 80;

interface Pointer {
  readonly start: Vec2;
  readonly kind: "primary" | "secondary";
  last: Vec2;
}

function minus(a: Vec2, b: Vec2): Vec2 {
  return [a[0] - b[0], a[1] - b[1]];
}

export class PointerInput {
  private readonly canvas: HTMLCanvasElement;
  private readonly gestures: Gestures;
  private readonly disposer = new Disposer();
  private readonly pointers = new Map<number, Pointer>();
  private dragging: number | null = null;
  private trail: { readonly atMs: number; readonly px: Vec2 }[] = [];

  constructor(canvas: HTMLCanvasElement, gestures: Gestures) {
    this.canvas = canvas;
    this.gestures = gestures;
    const d = this.disposer;
    d.listen(canvas, "pointerdown", (event: PointerEvent) => this.down(event));
    d.listen(canvas, "pointermove", (event: PointerEvent) => this.moved(event));
    d.listen(canvas, "pointerup", (event: PointerEvent) => this.up(event));
    d.listen(canvas, "pointercancel", (event: PointerEvent) => this.up(event));
    d.listen(canvas, "lostpointercapture", (event: PointerEvent) => this.up(event));
    d.listen(canvas, "contextmenu", (event: Event) => event.preventDefault());
    d.listen(canvas, "wheel", (event: WheelEvent) => this.wheel(event), { passive: false });
  }

  dispose(): void {
    this.disposer.dispose();
    this.pointers.clear();
  }

  private place(event: MouseEvent): Vec2 {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  private down(event: PointerEvent): void {
    if (event.button > 2) return;
    this.canvas.focus({ preventScroll: true });
    // No automatic scrolling with the middle button.
    if (event.button === 1) event.preventDefault();
    this.gestures.touched();
    this.endDrag(event.timeStamp);
    const px = this.place(event);
    const secondary = event.button !== 0 || event.ctrlKey || event.metaKey;
    if (this.pointers.size >= 2) return;
    this.pointers.set(event.pointerId, { start: px, last: px, kind: secondary ? "secondary" : "primary" });
  }

  private moved(event: PointerEvent): void {
    const pointer = this.pointers.get(event.pointerId);
    if (pointer === undefined) return;
    // The button was released where it is not heard of, outside the window say.
    if (event.pointerType === "mouse" && event.buttons === 0) {
      this.up(event);
      return;
    }
    const px = this.place(event);
    if (this.pointers.size === 2) {
      this.pinch(event.pointerId, pointer, px);
      return;
    }
    if (this.dragging === null) {
      const by = minus(px, pointer.start);
      if (Math.hypot(by[0], by[1]) <= CLICK_PX) return;
      this.dragging = event.pointerId;
      // The drag goes on outside the canvas.
      this.canvas.setPointerCapture(event.pointerId);
      this.gestures.begin(pointer.kind, pointer.start);
      pointer.last = pointer.start;
      this.trail = [];
    }
    if (this.dragging !== event.pointerId) return;
    this.trail = [
      ...this.trail.filter((point) => event.timeStamp - point.atMs < VELOCITY_MS),
      { atMs: event.timeStamp, px },
    ];
    this.gestures.move(px, minus(px, pointer.last));
    pointer.last = px;
  }

  private pinch(id: number, pointer: Pointer, px: Vec2): void {
    const other = [...this.pointers].find(([otherId]) => otherId !== id)?.[1];
    if (other === undefined) return;
    const before = minus(pointer.last, other.last);
    const after = minus(px, other.last);
    const [long, longer] = [Math.hypot(before[0], before[1]), Math.hypot(after[0], after[1])];
    const by: Vec2 = [(px[0] - pointer.last[0]) / 2, (px[1] - pointer.last[1]) / 2];
    pointer.last = px;
    if (long < 8 || longer < 8) return;
    let turn = Math.atan2(after[1], after[0]) - Math.atan2(before[1], before[0]);
    if (turn > Math.PI) turn -= 2 * Math.PI;
    if (turn < -Math.PI) turn += 2 * Math.PI;
    const middle: Vec2 = [(px[0] + other.last[0]) / 2, (px[1] + other.last[1]) / 2];
    this.gestures.pinch(middle, longer / long, (turn * 180) / Math.PI, by);
  }

  private up(event: PointerEvent): void {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.dragging === event.pointerId) this.endDrag(event.timeStamp);
    // The finger that stays begins a drag of its own only after another 4 pixels.
    for (const [id, pointer] of this.pointers)
      this.pointers.set(id, { start: pointer.last, last: pointer.last, kind: pointer.kind });
  }

  private endDrag(nowMs: number): void {
    if (this.dragging === null) return;
    this.dragging = null;
    const recent = this.trail.filter((point) => nowMs - point.atMs < VELOCITY_MS);
    const [first, last] = [recent[0], recent[recent.length - 1]];
    this.trail = [];
    const passed = first === undefined || last === undefined ? 0 : last.atMs - first.atMs;
    if (first === undefined || last === undefined || passed <= 0) {
      this.gestures.end([0, 0]);
      return;
    }
    const by = minus(last.px, first.px);
    this.gestures.end([by[0] / passed, by[1] / passed]);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    // Lines and pages in pixels.
    const unit = event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1;
    const delta = Math.min(LARGEST_WHEEL_PX, Math.max(-LARGEST_WHEEL_PX, event.deltaY * unit));
    if (!Number.isFinite(delta) || delta === 0) return;
    // Browsers report the spread of two fingers on a touchpad as a wheel with Ctrl and small steps.
    const rate = event.ctrlKey && Math.abs(delta) < 40 ? PINCH_RATE : WHEEL_RATE;
    this.gestures.wheel(this.place(event), Math.exp(delta * rate));
  }
}
