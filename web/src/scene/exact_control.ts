// Exact frames between engine, store and stage: which sides are wanted, when they are asked for, and which of those that come are shown. With the
// swipe on, the earlier project comes after the main one, as a client has one view at a time.
import type { Clock } from "../base/clock.js";
import { Disposer } from "../base/disposer.js";
import type { Vec2 } from "../base/vec.js";
import type { ExactFrame, Link, Which } from "../protocol/link_api.js";
import type { Project } from "../state/project.js";
import type { Store } from "../state/store.js";
import type { CameraRig } from "./camera_rig.js";
import type { ExactLayer } from "./exact_layer.js";
import { REST_MS, ViewRequests } from "./view_requests.js";
import { exactSize } from "./view_size.js";

export interface ExactControlOptions {
  readonly project: Project;
  readonly store: Store;
  readonly link: Link;
  readonly rig: CameraRig;
  readonly clock: Clock;
  layer(side: Which): ExactLayer | null;
  /** Device pixels of the canvas at rest. */
  canvasPx(): Vec2;
  /** The drawn picture is that of the present pose. */
  drawn(): boolean;
  invalidate(): void;
}

export class ExactControl {
  private readonly options: ExactControlOptions;
  private readonly requests: ViewRequests;
  private readonly disposer = new Disposer();

  constructor(options: ExactControlOptions) {
    this.options = options;
    const { store, link, clock, invalidate } = options;
    this.requests = this.disposer.own(
      new ViewRequests({
        clock,
        ask: (side) => this.ask(side),
        stop: () => link.stop(),
        sides: () => this.sides(),
        allowed: () => this.wanted(),
        onRest: invalidate,
        onProgress: (pass, passes) => this.setProgress(pass, passes),
      }),
    );
    const d = this.disposer;
    d.add(link.onFrame((frame) => this.onFrame(frame)));
    d.add(
      store.subscribe(
        (state) => state.layers.exact,
        () => this.renew(),
      ),
    );
    // A new merge: other pictures of the same view.
    d.add(
      store.subscribe(
        (state) => state.engine.revision,
        () => this.renew(),
      ),
    );
    d.add(
      store.subscribe(
        (state) => state.swipe.on,
        () => this.refresh(),
      ),
    );
    d.add(
      store.subscribe(
        (state) => state.compare === null && state.engine.connected && state.engine.ready,
        (free) => (free ? this.refreshSoon() : this.refresh()),
      ),
    );
  }

  /** The camera has been still for a while. */
  get resting(): boolean {
    return this.requests.resting;
  }

  /** Before/after is on, and there is an earlier project. */
  get swiping(): boolean {
    return this.options.store.get().swipe.on && this.options.project.before !== null;
  }

  /** What is shown is no longer what the engine would render: the camera moved, say. */
  renew(): void {
    for (const side of ["main", "before"] as const) this.options.layer(side)?.leave();
    this.requests.moved();
    this.options.invalidate();
  }

  /** Uploaded pictures are lost. */
  reset(): void {
    for (const side of ["main", "before"] as const) this.options.layer(side)?.clear();
    this.requests.moved();
  }

  dispose(): void {
    this.disposer.dispose();
  }

  private refresh(): void {
    this.requests.refresh();
    this.options.invalidate();
  }

  /** After what else happens now: a panel that closes ends its own view, and would end ours with it. */
  private refreshSoon(): void {
    const cancel = this.options.clock.after(REST_MS, () => {
      if (!this.disposer.disposed) this.refresh();
    });
    this.disposer.add(cancel);
  }

  private sides(): readonly Which[] {
    const { project } = this.options;
    const sides: Which[] = [];
    if (project.scene !== null) sides.push("main");
    if (this.swiping && project.before?.scene) sides.push("before");
    return sides;
  }

  /** Not while a photo is compared: its render is the panel's view. */
  private wanted(): boolean {
    const { engine, layers, compare } = this.options.store.get();
    return layers.exact && engine.connected && engine.ready && compare === null;
  }

  private ask(side: Which): number {
    const { pose } = this.options.rig;
    const { link } = this.options;
    const [w, h] = exactSize(...this.options.canvasPx(), link.instantPx);
    const ortho = pose.orthoHeightM;
    return link.view({
      project: side,
      eyeEnu: pose.eyeEnu,
      rotation: pose.rotation,
      fovyDeg: ortho === null ? pose.fovyDeg : null,
      orthoHeightM: ortho,
      w,
      h,
    });
  }

  private onFrame(frame: ExactFrame): void {
    // Photos are shown by their panel, which closes them.
    if (frame.isPhoto) return;
    const layer = this.options.layer(frame.project);
    if (layer === null || !this.options.drawn() || !this.wanted() || !this.requests.accept(frame)) {
      frame.bitmap.close();
      return;
    }
    layer.show(frame, this.options.canvasPx());
    this.options.invalidate();
  }

  private setProgress(pass: number, passes: number): void {
    const { store } = this.options;
    const { engine } = store.get();
    if (engine.pass !== pass || engine.passes !== passes) store.set({ engine: { ...engine, pass, passes } });
  }
}
