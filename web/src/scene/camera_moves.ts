// Moves that panels, tools and the mode of navigation ask for: flights to poses and boxes, and the change to and from the view from above.
import type { Vec3 } from "../base/vec.js";
import type { CameraPose, Enu, Navigation } from "../state/app_state.js";
import type { Store } from "../state/store.js";
import type { CameraRig } from "./camera_rig.js";
import { Flight, type Leg } from "./flight.js";
import { obliqueFromTop, obliquePose, perspectiveOf, topFrom, topPose } from "./framing.js";
import type { World } from "./world.js";

const FLIGHT_MS = 800;

export interface CameraMovesOptions {
  readonly rig: CameraRig;
  readonly world: World;
  readonly store: Store;
  reducedMotion(): boolean;
  /** What the middle of the view shows. */
  focus(): Vec3;
  invalidate(): void;
}

export class CameraMoves {
  private readonly options: CameraMovesOptions;
  private readonly flight = new Flight();

  constructor(options: CameraMovesOptions) {
    this.options = options;
  }

  get active(): boolean {
    return this.flight.active;
  }

  flyTo(pose: CameraPose, durationMs = FLIGHT_MS): Promise<void> {
    const { rig, world, reducedMotion } = this.options;
    const orthographic = pose.orthoHeightM !== null;
    if (!(durationMs > 0) || reducedMotion()) {
      this.flight.cancel();
      rig.set(pose);
      this.followMode(orthographic);
      this.options.invalidate();
      return Promise.resolve();
    }
    const legs: Leg[] = [];
    // Between the two projections one flies as a perspective that shows the ground at the same scale.
    if (rig.pose.orthoHeightM !== null && !orthographic) rig.set(perspectiveOf(rig.pose, world));
    if (rig.pose.orthoHeightM === null && orthographic) {
      legs.push({ to: perspectiveOf(pose, world), durationMs }, { to: pose, durationMs: 0 });
    } else {
      legs.push({ to: pose, durationMs });
    }
    const arrived = this.flight.start(rig.pose, legs);
    this.followMode(orthographic);
    this.options.invalidate();
    return arrived;
  }

  frameBox(min: Enu, max: Enu): Promise<void> {
    const { rig, world, store } = this.options;
    const low: Vec3 = [Math.min(min[0], max[0]), Math.min(min[1], max[1]), Math.min(min[2], max[2])];
    const high: Vec3 = [Math.max(min[0], max[0]), Math.max(min[1], max[1]), Math.max(min[2], max[2])];
    const box = { min: low, max: high };
    if (![...low, ...high].every(Number.isFinite)) return Promise.resolve();
    return this.flyTo(store.get().navigation === "top" ? topPose(box, rig.size, world) : obliquePose(box, rig.size));
  }

  /** The mode was chosen. */
  setMode(mode: Navigation): void {
    const { rig, world, focus } = this.options;
    const now = this.flight.target ?? rig.pose;
    const orthographic = now.orthoHeightM !== null;
    if ((mode === "top") === orthographic) return;
    void this.flyTo(mode === "top" ? topFrom(rig.pose, focus(), world, 0) : obliqueFromTop(now, world));
  }

  /** The person takes over. A change of projection is completed, so that pose and mode agree. */
  interrupt(): void {
    const { target } = this.flight;
    if (target === null) return;
    if ((target.orthoHeightM === null) !== (this.options.rig.pose.orthoHeightM === null)) this.options.rig.set(target);
    this.flight.cancel();
  }

  step(nowMs: number): void {
    const pose = this.flight.step(nowMs);
    if (pose !== null) this.options.rig.set(pose);
  }

  dispose(): void {
    this.flight.cancel();
  }

  /** A pose from elsewhere decides about the mode as well. */
  private followMode(orthographic: boolean): void {
    const { store } = this.options;
    const { navigation } = store.get();
    if (orthographic && navigation !== "top") store.set({ navigation: "top" });
    else if (!orthographic && navigation === "top") store.set({ navigation: "map" });
  }
}
