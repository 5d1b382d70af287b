// Labels and markers of a tour as elements over the canvas: texts as text, markers as buttons, so that keyboards and screen readers find them. The style
// sheet gives them their look (entry/look/things.css); here are only their places.
import type { Vec2 } from "../base/vec.js";
import type { CameraPose, Enu } from "../state/app_state.js";
import { svgElement } from "./svg.js";
import type { TextThing } from "./thing.js";
import { byId, changesBetween } from "./thing_changes.js";
import { cameraFromEnu, projectPoint, type Size } from "./view_math.js";

/** Farther outside the canvas nothing of them can be seen. */
const MARGIN_PX = 200;
const NEAREST_ORDER = 1_000_000;

interface Shown {
  readonly thing: TextThing;
  readonly element: HTMLElement;
  /** What was written last: pages are slow to compare. */
  transform: string;
  visible: boolean;
}

/** A pin whose tip is at the place. */
function pin(): SVGSVGElement {
  const svg = svgElement("svg", {
    class: "thing-pin",
    viewBox: "0 0 20 26",
    width: 20,
    height: 26,
    "aria-hidden": "true",
  });
  svg.append(
    svgElement("path", {
      class: "thing-pin-shape",
      d: "M10 25C7 19 1 15.500 1 9.500a9 9 0 0 1 18 0C19 15.500 13 19 10 25Z",
    }),
    svgElement("circle", { class: "thing-pin-hole", cx: 10, cy: 9.5, r: 3.5 }),
  );
  return svg;
}

export class ThingsOverlay {
  private readonly root: HTMLElement;
  private readonly canvas: HTMLCanvasElement;
  private readonly chosen: (id: string) => void;
  private readonly shown = new Map<string, Shown>();
  private list: ReadonlyMap<string, TextThing> = new Map();
  private marks: readonly [string | null, string | null] = [null, null];

  constructor(container: HTMLElement, canvas: HTMLCanvasElement, chosen: (id: string) => void) {
    this.canvas = canvas;
    this.chosen = chosen;
    this.root = document.createElement("div");
    this.root.className = "scene-things";
    container.append(this.root);
  }

  get things(): ReadonlyMap<string, TextThing> {
    return this.list;
  }

  /** True when something has changed. */
  set(list: readonly TextThing[]): boolean {
    const next = byId(list);
    const { added, removed, changed } = changesBetween(this.list, next);
    if (added.length === 0 && removed.length === 0 && changed.length === 0) return false;
    this.list = next;
    for (const { id } of removed) this.remove(id);
    for (const { after } of changed) this.replace(after);
    for (const thing of added) this.replace(thing);
    this.mark();
    return true;
  }

  highlight(selected: string | null, hovered: string | null): void {
    this.marks = [selected, hovered];
    this.mark();
  }

  /** `sees`: nothing is in front of it. */
  update(pose: CameraPose, size: Size, sees: (thing: TextThing) => boolean): void {
    for (const shown of this.shown.values()) {
      const px = placeOf(pose, size, shown.thing.at);
      const visible = px !== null && sees(shown.thing);
      if (visible) this.move(shown, pose, px);
      if (visible === shown.visible) continue;
      shown.visible = visible;
      // The keyboard must not be left on what cannot be seen.
      if (!visible && document.activeElement === shown.element) this.canvas.focus({ preventScroll: true });
      shown.element.style.visibility = visible ? "visible" : "hidden";
    }
  }

  /** Id of what is seen at this place, the nearest in front. */
  pick(px: Vec2): string | null {
    const frame = this.canvas.getBoundingClientRect();
    const [x, y] = [frame.left + px[0], frame.top + px[1]];
    let best: { id: string; order: number } | null = null;
    for (const { thing, element, visible } of this.shown.values()) {
      if (!visible) continue;
      const box = element.getBoundingClientRect();
      if (x < box.left || x > box.right || y < box.top || y > box.bottom) continue;
      const order = Number(element.style.zIndex);
      if (best === null || order > best.order) best = { id: thing.id, order };
    }
    return best?.id ?? null;
  }

  /** Ids of those that are seen now. */
  visible(): string[] {
    return [...this.shown.values()].filter(({ visible }) => visible).map(({ thing }) => thing.id);
  }

  dispose(): void {
    this.root.remove();
    this.shown.clear();
    this.list = new Map();
  }

  private move(shown: Shown, pose: CameraPose, [x, y]: Vec2): void {
    const transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -100%)`;
    if (transform === shown.transform) return;
    shown.transform = transform;
    shown.element.style.transform = transform;
    const z = cameraFromEnu(pose, shown.thing.at)[2];
    // Near ones over far ones: steps of about 0.1 %, whatever the distance.
    shown.element.style.zIndex = String(NEAREST_ORDER - Math.round(1000 * Math.log(Math.max(1e-3, z))));
  }

  private replace(thing: TextThing): void {
    const before = this.shown.get(thing.id);
    const element = this.makeElement(thing);
    element.style.position = "absolute";
    element.style.left = "0";
    element.style.top = "0";
    element.style.visibility = "hidden";
    if (before === undefined) this.root.append(element);
    else before.element.replaceWith(element);
    this.shown.set(thing.id, { thing, element, transform: "", visible: false });
  }

  private makeElement(thing: TextThing): HTMLElement {
    const text = document.createElement("span");
    text.className = "thing-text";
    // Any script, in its own direction.
    text.dir = "auto";
    text.textContent = thing.text;
    if (thing.kind === "label") {
      const label = document.createElement("div");
      label.className = "thing-label";
      label.append(text);
      return label;
    }
    const button = document.createElement("button");
    button.type = "button";
    button.className = "thing-marker";
    button.append(text, pin());
    button.addEventListener("click", () => this.chosen(thing.id));
    // Zooming goes on over it.
    button.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.canvas.dispatchEvent(new WheelEvent("wheel", event));
    });
    return button;
  }

  private remove(id: string): void {
    const shown = this.shown.get(id);
    if (shown === undefined) return;
    if (document.activeElement === shown.element) this.canvas.focus({ preventScroll: true });
    shown.element.remove();
    this.shown.delete(id);
  }

  private mark(): void {
    const [selected, hovered] = this.marks;
    for (const [id, { element }] of this.shown) {
      element.classList.toggle("thing-selected", id === selected);
      element.classList.toggle("thing-hovered", id === hovered);
    }
  }
}

/** Where on the canvas, or near it; null: nowhere. */
export function placeOf(pose: CameraPose, size: Size, at: Enu): Vec2 | null {
  const px = projectPoint(pose, size, at);
  if (px === null) return null;
  const [x, y] = px;
  return x > -MARGIN_PX && y > -MARGIN_PX && x < size[0] + MARGIN_PX && y < size[1] + MARGIN_PX ? px : null;
}
