// Places what the tour shows in the scene: a label, a marker, a model, by a click on the surface or on a model. It also moves them, and takes the point
// around which a way leads.
import type { Vec3 } from "../base/vec.js";
import { norm, sub } from "../base/vec_math.js";
import type { Documents } from "../state/app_state.js";
import { addNotice } from "../state/notices.js";
import { changeTour, setTourView } from "../state/tour_changes.js";
import type { Placing } from "../state/tour_state.js";
import { setCentre } from "../state/tour_ways.js";
import { addThing, moveThing, newLabel, newMarker, newModel, thingOf } from "../tour/edit_things.js";
import type { Thing, Tour } from "../tour/types.js";
import { NO_SURFACE } from "./draft_tool.js";
import type { SurfacePicker } from "./surface_picker.js";
import type { Tool, ToolPointer } from "./tool.js";
import type { ToolContext } from "./tool_context.js";

/** A model in front of the surface is at least this much nearer. */
const IN_FRONT_M = 0.01;

export class ThingTool implements Tool {
  readonly name = "thing";
  private readonly context: ToolContext;
  private readonly picker: SurfacePicker;

  constructor(context: ToolContext, picker: SurfacePicker) {
    this.context = context;
    this.picker = picker;
  }

  activate(): void {
    const { store } = this.context;
    const { tour } = store.get();
    if (tour.placing === null) setTourView(store, { placing: { kind: "label" } });
  }

  deactivate(): void {
    setTourView(this.context.store, { placing: null });
  }

  hover({ px }: ToolPointer): void {
    const { scene, store } = this.context;
    scene.highlightThings(store.get().tour.thing, scene.pickThing(px));
  }

  click({ px, shift }: ToolPointer): boolean {
    const { store, scene } = this.context;
    const { placing } = store.get().tour;
    if (placing === null) return true;
    const place = scene.pickPlace(px);
    const { mesh, field } = this.picker.pick(px);
    if (place !== null && (mesh === null || norm(sub(place.enu, mesh.enu)) > IN_FRONT_M)) {
      // On a model, of which the field knows nothing.
      this.put(place.enu, placing, shift);
    } else if (mesh !== null) {
      const at = mesh.enu;
      this.put(at, placing, shift);
      void field.then((found) => {
        if (found !== null) store.amendDocuments((documents) => withBetterPlace(documents, at, found.enu));
      });
    } else {
      void field.then((found) => {
        if (found === null) addNotice(store, "info", NO_SURFACE);
        else this.put(found.enu, placing, shift);
      });
    }
    return true;
  }

  doubleClick(): boolean {
    return true;
  }

  key(): boolean {
    // Escape ends the tool.
    return false;
  }

  private put(at: Vec3, placing: Placing, again: boolean): void {
    const { store } = this.context;
    switch (placing.kind) {
      case "move":
        changeTour(store, "move thing", (tour) => moveThing(tour, placing.thing, at));
        break;
      case "centre":
        changeTour(store, "set the middle of the way", (tour) => setCentre(tour, placing.stop, placing.branch, at));
        break;
      default: {
        let id: string | null = null;
        const done = changeTour(store, `add ${placing.kind}`, (tour) => {
          const thing = made(tour, placing, at);
          id = thing.id;
          return addThing(tour, thing, placing.kind === "model" ? placing.asset : undefined);
        });
        if (done) setTourView(store, { thing: id, stop: null });
      }
    }
    // In its form it gets its text.
    store.set({ panel: "tour" });
    if (!again || placing.kind === "move" || placing.kind === "centre") store.set({ tool: "navigate" });
  }
}

function made(tour: Tour, placing: Exclude<Placing, { readonly kind: "move" | "centre" }>, at: Vec3): Thing {
  const count = tour.things.filter(({ kind }) => kind === placing.kind).length + 1;
  switch (placing.kind) {
    case "label":
      return newLabel(tour, `Label ${count}`, at);
    case "marker":
      return newMarker(tour, `Marker ${count}`, at, null);
    case "model":
      return newModel(tour, placing.asset.name.replace(/\.glb$/i, "") || "Model", at, placing.asset.file);
    default:
      return placing satisfies never;
  }
}

/** The field's place where that of the mesh (this very object) is. */
function withBetterPlace(documents: Documents, placed: Vec3, better: Vec3): Documents {
  const { tour } = documents;
  const thing = tour.things.find(({ at }) => at === placed);
  if (thing !== undefined && thingOf(tour, thing.id) !== null) {
    return { ...documents, tour: moveThing(tour, thing.id, better) };
  }
  for (const stop of tour.stops) {
    const next = stop.next?.path;
    if (next?.kind === "orbit" && next.about === placed)
      return { ...documents, tour: setCentre(tour, stop.id, null, better) };
    const branch = stop.branches.findIndex(({ path }) => path.kind === "orbit" && path.about === placed);
    if (branch >= 0) return { ...documents, tour: setCentre(tour, stop.id, branch, better) };
  }
  return documents;
}
