// The part that all measuring tools share: points are clicked one by one into the draft, which is then made into a measurement.
import type { Vec2 } from "../base/vec.js";
import type { Documents, Measurement, SurfacePoint, ToolName } from "../state/app_state.js";
import { replacePoint, withMeasurement } from "../state/measurements.js";
import { addErrorNotice, addNotice } from "../state/notices.js";
import type { SurfacePicker } from "./surface_picker.js";
import type { Tool, ToolPointer } from "./tool.js";
import type { ToolContext } from "./tool_context.js";

/** What is particular to one kind of measurement. */
export interface DraftKind {
  readonly name: ToolName;
  /** "distance", for the list of steps. */
  readonly what: string;
  readonly least: number;
  /** Finishes by itself with this many points. */
  readonly full: number;
  /** More are refused; null: any number. */
  readonly most: number | null;
  /** A click on the first point finishes. */
  readonly closed: boolean;
  /** Why these points cannot be finished; null: they can. */
  problem(points: readonly SurfacePoint[]): string | null;
  readonly how: ByItself | ByEngine;
}
/** Made from the points alone, again whenever one becomes better. */
export interface ByItself {
  readonly by: "itself";
  make(documents: Documents, points: readonly SurfacePoint[]): Measurement;
}
/** Measured by the engine, between the field's points. */
export interface ByEngine {
  readonly by: "engine";
  measure(points: readonly SurfacePoint[]): Promise<(documents: Documents) => Measurement>;
}

/** Points that the engine is measuring. */
interface Asking {
  points: readonly SurfacePoint[];
  cancelled: boolean;
}

export const NO_SURFACE = "There is no surface here: click where something is shown.";
const CLOSE_PX = 8;
/** Where less is left, the panel would cover what is measured. */
const WIDE_PX = 700;

export class DraftTool implements Tool {
  readonly name: ToolName;
  private readonly kind: DraftKind;
  private readonly context: ToolContext;
  private readonly picker: SurfacePicker;
  private readonly asking = new Set<Asking>();
  /** Grows with every draft: what belongs to an older one is recognised by it. */
  private draftNumber = 0;
  /** Clicks where only the field can give the point. */
  private pending = 0;
  private active = false;

  constructor(kind: DraftKind, context: ToolContext, picker: SurfacePicker) {
    this.kind = kind;
    this.name = kind.name;
    this.context = context;
    this.picker = picker;
  }

  activate(): void {
    this.active = true;
    this.startAnew();
  }

  deactivate(): void {
    this.active = false;
    this.startAnew();
  }

  hover(): void {
    const { store } = this.context;
    const { readout, draft } = store.get();
    const closed = draft.length === 0 || this.isAsked(draft);
    store.set({ hover: closed ? null : readout.cursor });
  }

  click({ px }: ToolPointer): boolean {
    const { store } = this.context;
    if (this.isAsked(store.get().draft)) this.startAnew();
    const draft = store.get().draft;
    if (this.kind.closed && draft.length >= this.kind.least && this.isNear(draft[0], px)) {
      this.finish();
      return true;
    }
    if (this.kind.most !== null && draft.length >= this.kind.most) {
      addNotice(store, "info", `A ${this.kind.what} can have at most ${this.kind.most} points: finish it with Enter.`);
      return true;
    }
    const { mesh, field } = this.picker.pick(px);
    if (mesh !== null) {
      this.addPoint(mesh, draft.length + this.pending);
      void field.then((found) => {
        if (found !== null) this.replace(mesh, found);
      });
    } else {
      void this.addFieldPoint(field, draft.length + this.pending);
    }
    return true;
  }

  doubleClick(): boolean {
    // The first click has set the last point.
    if (this.context.store.get().draft.length > 0) this.finish();
    return true;
  }

  key(key: string): boolean {
    const { store } = this.context;
    const { draft } = store.get();
    if (draft.length === 0) return false;
    switch (key) {
      case "Enter":
        this.finish();
        return true;
      case "Backspace":
        this.cancelAsked(draft);
        store.set({ draft: draft.slice(0, -1), ...(draft.length === 1 ? { hover: null } : {}) });
        return true;
      case "Escape":
        this.cancelAsked(draft);
        this.startAnew();
        return true;
      default:
        return false;
    }
  }

  private startAnew(): void {
    this.draftNumber += 1;
    this.pending = 0;
    this.context.store.set({ draft: [], hover: null });
  }

  private isNear(point: SurfacePoint | undefined, px: Vec2): boolean {
    const at = point === undefined ? null : this.context.scene.project(point.enu);
    return at !== null && Math.hypot(at[0] - px[0], at[1] - px[1]) <= CLOSE_PX;
  }

  private addPoint(point: SurfacePoint, place: number): void {
    const { store } = this.context;
    const { draft } = store.get();
    const next = [...draft.slice(0, place), point, ...draft.slice(place)];
    store.set({ draft: next });
    if (next.length >= this.kind.full) this.finish();
  }

  private async addFieldPoint(field: Promise<SurfacePoint | null>, place: number): Promise<void> {
    const own = this.draftNumber;
    this.pending += 1;
    const found = await field;
    if (own !== this.draftNumber) return;
    this.pending -= 1;
    if (found === null) addNotice(this.context.store, "info", NO_SURFACE);
    else this.addPoint(found, place);
  }

  /** Wherever the point has come to meanwhile: in the draft, with the engine, in a measurement. No step of its own. */
  private replace(picked: SurfacePoint, found: SurfacePoint): void {
    const { store, project } = this.context;
    const swap = (points: readonly SurfacePoint[]) => points.map((point) => (point === picked ? found : point));
    const { draft } = store.get();
    const newDraft = draft.includes(picked) ? swap(draft) : draft;
    for (const asking of this.asking) {
      // The draft that is being measured must still be recognised.
      if (asking.points === draft) asking.points = newDraft;
      else if (asking.points.includes(picked)) asking.points = swap(asking.points);
    }
    if (newDraft !== draft) store.set({ draft: newDraft });
    store.amendDocuments((documents) => replacePoint(documents, picked, found, project));
  }

  private isAsked(draft: readonly SurfacePoint[]): boolean {
    return [...this.asking].some(({ points }) => points === draft);
  }

  private cancelAsked(draft: readonly SurfacePoint[]): void {
    for (const asking of this.asking) {
      if (asking.points === draft) asking.cancelled = true;
    }
  }

  private finish(): void {
    const { store } = this.context;
    const points = store.get().draft;
    if (this.isAsked(points)) return;
    if (this.pending > 0) {
      const own = this.draftNumber;
      void this.picker.idle().then(() => {
        if (own === this.draftNumber && this.pending === 0) this.finish();
      });
      return;
    }
    const problem =
      points.length < this.kind.least
        ? `A ${this.kind.what} needs at least ${this.kind.least} points: click on the surface.`
        : this.kind.problem(points);
    if (problem !== null) {
      addNotice(store, "info", problem);
      return;
    }
    const { how } = this.kind;
    if (how.by === "itself") {
      this.put((documents) => how.make(documents, points));
      this.startAnew();
      return;
    }
    store.set({ hover: null });
    void this.ask({ points, cancelled: false }, how);
  }

  private async ask(asking: Asking, how: ByEngine): Promise<void> {
    this.asking.add(asking);
    try {
      await this.picker.idle();
      if (asking.cancelled) return;
      const make = await how.measure(asking.points);
      if (asking.cancelled) return;
      this.put(make);
      if (this.context.store.get().draft === asking.points) this.startAnew();
    } catch (error) {
      // The draft stays: Enter tries again.
      if (!asking.cancelled) addErrorNotice(this.context.store, `The ${this.kind.what} could not be measured`, error);
    } finally {
      this.asking.delete(asking);
    }
  }

  private put(make: (documents: Documents) => Measurement): void {
    const { store, scene } = this.context;
    const measurement = make(store.get().documents);
    store.changeDocuments(`add ${this.kind.what}`, (documents) => withMeasurement(documents, measurement));
    // Somebody who has gone on to another tool looks at something else.
    if (!this.active) return;
    store.set({ selected: measurement.id, ...(scene.canvas.clientWidth >= WIDE_PX ? { panel: "measure" } : {}) });
  }
}
