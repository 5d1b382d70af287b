// Places a control point on the surface: the selected one is moved, else a new one is made. Marks in photos are set in the photos' own dialog.
import type { Vec3 } from "../base/vec.js";
import { mapFromEnu } from "../geo/projection.js";
import type { ControlPoint, Documents } from "../state/app_state.js";
import { freeName } from "../state/names.js";
import { addNotice } from "../state/notices.js";
import { NO_SURFACE } from "./draft_tool.js";
import type { SurfacePicker } from "./surface_picker.js";
import type { Tool, ToolPointer } from "./tool.js";
import type { ToolContext } from "./tool_context.js";

export class ControlTool implements Tool {
  readonly name = "control";
  private readonly context: ToolContext;
  private readonly picker: SurfacePicker;

  constructor(context: ToolContext, picker: SurfacePicker) {
    this.context = context;
    this.picker = picker;
  }

  activate(): void {}
  deactivate(): void {}
  hover(): void {}

  click({ px, shift }: ToolPointer): boolean {
    const { store } = this.context;
    const { mesh, field } = this.picker.pick(px);
    const selected = shift ? null : store.get().selectedControl;
    if (mesh !== null) {
      const xyz = this.coordinates(mesh.enu);
      this.put(xyz, selected);
      void field.then((found) => {
        if (found !== null)
          store.amendDocuments((documents) => withBetterPlace(documents, xyz, this.coordinates(found.enu)));
      });
    } else {
      void field.then((found) => {
        if (found === null) addNotice(store, "info", NO_SURFACE);
        else this.put(this.coordinates(found.enu), selected);
      });
    }
    return true;
  }

  doubleClick(): boolean {
    return true;
  }

  key(key: string): boolean {
    const { store } = this.context;
    if (key !== "Escape" || store.get().selectedControl === null) return false;
    store.set({ selectedControl: null });
    return true;
  }

  private coordinates(enu: Vec3): Vec3 {
    return mapFromEnu(this.context.project, enu) ?? enu;
  }

  private put(xyz: Vec3, selected: string | null): void {
    const { store } = this.context;
    const points = store.get().documents.controlPoints;
    if (points.some(({ name }) => name === selected)) {
      const move = (point: ControlPoint) => (point.name === selected ? { ...point, xyz } : point);
      store.changeDocuments("move control point", (documents) => ({
        ...documents,
        controlPoints: documents.controlPoints.map(move),
      }));
      return;
    }
    const name = freeName(
      "GCP",
      points.map((point) => point.name),
    );
    store.changeDocuments("add control point", (documents) => ({
      ...documents,
      controlPoints: [...documents.controlPoints, { name, xyz, marks: [] }],
    }));
    store.set({ selectedControl: name, panel: "control" });
    addNotice(store, "info", `${name} was placed. Another click corrects it, Shift and a click place the next one.`);
  }
}

/** The field's coordinates where those of the mesh (this very object) are. */
function withBetterPlace(documents: Documents, placed: Vec3, better: Vec3): Documents {
  if (!documents.controlPoints.some(({ xyz }) => xyz === placed)) return documents;
  const controlPoints = documents.controlPoints.map((point) =>
    point.xyz === placed ? { ...point, xyz: better } : point,
  );
  return { ...documents, controlPoints };
}
