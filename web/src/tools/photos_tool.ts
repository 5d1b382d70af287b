// Click a point: which photos see it?
import type { SurfacePoint } from "../state/app_state.js";
import { addErrorNotice, addNotice } from "../state/notices.js";
import { NO_SURFACE } from "./draft_tool.js";
import type { SurfacePicker } from "./surface_picker.js";
import type { Tool, ToolPointer } from "./tool.js";
import type { ToolContext } from "./tool_context.js";

export class PhotosTool implements Tool {
  readonly name = "photos";
  private readonly context: ToolContext;
  private readonly picker: SurfacePicker;
  /** Only the newest click counts. */
  private clicks = 0;

  constructor(context: ToolContext, picker: SurfacePicker) {
    this.context = context;
    this.picker = picker;
  }

  activate(): void {}

  deactivate(): void {
    this.clicks += 1;
    this.context.store.set({ draft: [], hover: null });
  }

  hover(): void {}

  click({ px }: ToolPointer): boolean {
    this.clicks += 1;
    void this.look(px, this.clicks);
    return true;
  }

  doubleClick(): boolean {
    return true;
  }

  key(key: string): boolean {
    const { store } = this.context;
    if (key !== "Escape" || (store.get().sights === null && store.get().draft.length === 0)) return false;
    this.clicks += 1;
    store.set({ draft: [], sights: null });
    return true;
  }

  private async look(px: ToolPointer["px"], click: number): Promise<void> {
    const { store, link } = this.context;
    const { mesh, field } = this.picker.pick(px);
    // A mark at once; the photos take a moment.
    store.set({ draft: mesh === null ? [] : [mesh] });
    const point: SurfacePoint | null = (await field) ?? mesh;
    if (click !== this.clicks) return;
    if (point === null) {
      addNotice(store, "info", NO_SURFACE);
      return;
    }
    store.set({ draft: [point] });
    try {
      const { checked, photos } = await link.photosAt(point.enu);
      if (click === this.clicks) store.set({ sights: { point, checked, photos }, panel: "photos" });
    } catch (error) {
      if (click === this.clicks) addErrorNotice(store, "Photos that see the point were not found", error);
    }
  }
}
