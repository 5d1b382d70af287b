// No tool: the mouse moves the camera. A click on a measurement, a thing of the tour or a building selects it.
import type { Vec2 } from "../base/vec.js";
import type { Enu, Measurement } from "../state/app_state.js";
import { setTourView } from "../state/tour_changes.js";
import type { Tool, ToolPointer } from "./tool.js";
import type { ToolContext } from "./tool_context.js";

const NEAR_PX = 8;

export class NavigateTool implements Tool {
  readonly name = "navigate";
  private readonly context: Pick<ToolContext, "store" | "scene">;

  constructor(context: Pick<ToolContext, "store" | "scene">) {
    this.context = context;
  }

  activate(): void {}

  deactivate(): void {
    this.showHovered(null);
  }

  hover({ px }: ToolPointer): void {
    if (this.context.store.get().play === null) this.showHovered(this.buildingAt(px));
  }

  click({ px }: ToolPointer): boolean {
    const { store, scene } = this.context;
    const { documents, layers, selected, play, tour } = store.get();
    // Visitors look around; what they can choose are the markers.
    if (play !== null) return false;
    const found = layers.measurements
      ? measurementAt(documents.measurements, px, (point) => scene.project(point))
      : null;
    if (found !== selected) store.set({ selected: found });
    if (found !== null) return true;
    const thing = tour.locked === null && layers.things ? scene.pickThing(px) : null;
    if (thing !== tour.thing) setTourView(store, { thing });
    if (thing !== null) {
      store.set({ panel: "tour" });
      return true;
    }
    const building = this.buildingAt(px);
    // Its measures are in the panel.
    if (building !== null) store.set({ selectedBuilding: building, panel: "buildings" });
    else if (store.get().selectedBuilding !== null) store.set({ selectedBuilding: null });
    return building !== null;
  }

  doubleClick(): boolean {
    return false;
  }

  key(key: string): boolean {
    const { store } = this.context;
    const { selected, selectedBuilding, tour } = store.get();
    if (key !== "Escape") return false;
    if (selected !== null) store.set({ selected: null });
    else if (tour.thing !== null) setTourView(store, { thing: null });
    else if (selectedBuilding !== null) store.set({ selectedBuilding: null });
    else return false;
    return true;
  }

  private buildingAt(px: Vec2): number | null {
    const { store, scene } = this.context;
    return store.get().layers.buildings ? scene.pickBuilding(px) : null;
  }

  private showHovered(id: number | null): void {
    const { store } = this.context;
    if (store.get().hoverBuilding !== id) store.set({ hoverBuilding: id });
  }
}

/** Id of the measurement whose points or lines are nearest to the place, within 8 pixels; null: none. */
export function measurementAt(
  measurements: readonly Measurement[],
  px: Vec2,
  project: (point: Enu) => Vec2 | null,
): string | null {
  let nearest = NEAR_PX;
  let id: string | null = null;
  for (const { id: own, kind, points } of measurements) {
    const places = points.map(({ enu }) => project(enu));
    const closed = kind === "area" || kind === "volume";
    places.forEach((a, i) => {
      const b = i + 1 < places.length ? places[i + 1] : closed ? places[0] : a;
      // A line that leaves behind the camera has no place on the canvas.
      if (a === null || a === undefined || b === null || b === undefined) return;
      const distance = distanceToLine(px, a, b);
      if (distance <= nearest) {
        nearest = distance;
        id = own;
      }
    });
  }
  return id;
}

/** From p to the line between a and b. */
function distanceToLine(p: Vec2, a: Vec2, b: Vec2): number {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const square = dx * dx + dy * dy;
  const along = square > 0 ? ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square : 0;
  const u = Math.min(1, Math.max(0, along));
  return Math.hypot(p[0] - a[0] - u * dx, p[1] - a[1] - u * dy);
}
