// Gestures and keys to camera poses: like a map (pan, orbit, zoom to the cursor), in flight (look and move), or from above (pan, turn, zoom).
import type { Disposer } from "../base/disposer.js";
import type { Vec2, Vec3 } from "../base/vec.js";
import { add, norm, scale, sub } from "../base/vec_math.js";
import { forward } from "../geo/camera.js";
import type { CameraPose, Navigation as Mode } from "../state/app_state.js";
import type { CameraRig } from "./camera_rig.js";
import { type HeldKey, HeldKeys, listenToKeys } from "./key_input.js";
import { flyBy, keepNear, onPlane, orbit, panBy, panTo, turn, zoomAt } from "./map_motion.js";
import { type Gestures, PointerInput } from "./pointer_input.js";
import { rayAt } from "./view_math.js";
import type { World } from "./world.js";

export interface NavigationOptions {
  readonly canvas: HTMLCanvasElement;
  readonly rig: CameraRig;
  readonly world: World;
  mode(): Mode;
  reducedMotion(): boolean;
  /** The surface under a place of the canvas. */
  pick(px: Vec2): Vec3 | null;
  /** z of the surface at a place of the map; null: none. */
  groundAt(x: number, y: number): number | null;
  /** The person takes over: a flight ends. */
  onInput(): void;
  invalidate(): void;
}

const ORBIT_DEG_PER_PX = 0.25;
const CLEARANCE_M = 0.5;
const KEY_PAN_PER_S = 0.6;
const KEY_ORBIT_DEG_PER_S = 60;
const KEY_ZOOM_PER_S = 1.6;
const FAST = 4;
/** Share of the speed that is left after a second. */
const GLIDE_PER_S = 0.0005;
const SLOWEST_GLIDE = 0.02;

export class Navigation implements Gestures {
  private readonly options: NavigationOptions;
  private readonly input: PointerInput;
  private readonly keys: Disposer;
  private readonly held = new HeldKeys();
  private drag: { readonly kind: "primary" | "secondary"; readonly place: Vec3 | null } | null = null;
  /** Pixels per millisecond after the drag. */
  private glide: Vec2 = [0, 0];
  private wheelPlace: { readonly px: Vec2; readonly place: Vec3; readonly atMs: number } | null = null;
  private speedMps: number;

  constructor(options: NavigationOptions) {
    this.options = options;
    this.speedMps = Math.min(500, Math.max(1, options.world.sizeM / 15));
    this.input = new PointerInput(options.canvas, this);
    this.keys = listenToKeys(options.canvas, this.held, options.mode, () => {
      this.glide = [0, 0];
      options.onInput();
      options.invalidate();
    });
  }

  /** Something moves by itself: keys that are held, or the rest of a drag. */
  get active(): boolean {
    return this.held.active || this.glide[0] !== 0 || this.glide[1] !== 0;
  }

  stop(): void {
    this.glide = [0, 0];
    this.held.clear();
  }

  dispose(): void {
    this.input.dispose();
    this.keys.dispose();
  }

  step(dtMs: number): void {
    for (const key of this.held.step(dtMs)) this.applyKey(key);
    const [x, y] = this.glide;
    if (x === 0 && y === 0) return;
    const { rig } = this.options;
    this.set(panBy(rig.pose, rig.size, [-x * dtMs, y * dtMs], this.distance()));
    const left = GLIDE_PER_S ** (dtMs / 1000);
    this.glide = Math.hypot(x, y) * left < SLOWEST_GLIDE ? [0, 0] : [x * left, y * left];
  }

  // ---- gestures ----

  touched(): void {
    this.glide = [0, 0];
    this.options.onInput();
  }

  begin(kind: "primary" | "secondary", px: Vec2): void {
    const { mode } = this.options;
    const place = mode() === "fly" ? null : kind === "secondary" && mode() === "top" ? this.middle() : this.placeAt(px);
    this.drag = { kind, place };
  }

  move(px: Vec2, byPx: Vec2): void {
    const { rig, mode } = this.options;
    if (this.drag === null) return;
    const { kind, place } = this.drag;
    if (mode() === "fly") {
      // The picture follows the pointer.
      const rate = rig.pose.fovyDeg / Math.max(1, rig.size[1]);
      this.set(turn(rig.pose, -byPx[0] * rate, byPx[1] * rate));
    } else if (kind === "secondary" && place !== null) {
      const pitch = mode() === "top" ? 0 : -byPx[1] * ORBIT_DEG_PER_PX;
      this.set(orbit(rig.pose, place, byPx[0] * ORBIT_DEG_PER_PX, pitch));
    } else if (place !== null) {
      this.set(panTo(rig.pose, rig.size, place, px));
    } else {
      this.set(panBy(rig.pose, rig.size, [-byPx[0], byPx[1]], this.distance()));
    }
  }

  end(velocity: Vec2): void {
    const glides = this.drag?.kind === "primary" && this.options.mode() !== "fly" && !this.options.reducedMotion();
    this.drag = null;
    this.glide = glides && Math.hypot(velocity[0], velocity[1]) > 0.1 ? velocity : [0, 0];
    this.options.invalidate();
  }

  pinch(middlePx: Vec2, factor: number, turnDeg: number, byPx: Vec2): void {
    const { rig, world, mode } = this.options;
    const place = this.placeAt(middlePx) ?? this.middle();
    let pose = zoomAt(rig.pose, place, 1 / factor, world);
    if (mode() === "top") pose = panBy(orbit(pose, place, -turnDeg, 0), rig.size, [-byPx[0], byPx[1]], this.distance());
    else pose = orbit(pose, place, -turnDeg, -byPx[1] * ORBIT_DEG_PER_PX);
    this.set(pose);
  }

  wheel(px: Vec2, factor: number): void {
    this.touched();
    const { rig, world, mode } = this.options;
    if (mode() === "fly") {
      this.speedMps = Math.min(1000, Math.max(0.2, this.speedMps / factor));
      return;
    }
    const now = performance.now();
    const last = this.wheelPlace;
    // One place for a whole turn of the wheel, so that it does not slip to what is behind an edge.
    const same = last !== null && now - last.atMs < 400 && Math.hypot(px[0] - last.px[0], px[1] - last.px[1]) < 3;
    const place = same
      ? last.place
      : (this.placeAt(px) ??
        add(rayAt(rig.pose, rig.size, px).originEnu, scale(rayAt(rig.pose, rig.size, px).direction, this.distance())));
    this.wheelPlace = { px, place, atMs: now };
    this.set(zoomAt(rig.pose, place, factor, world));
  }

  // ---- keys ----

  private applyKey({ move, shift, ms }: HeldKey): void {
    const { rig, world, mode } = this.options;
    const seconds = ms / 1000;
    if (mode() === "fly") {
      const metres = this.speedMps * seconds * (shift ? FAST : 1);
      this.set(flyPose(rig.pose, move, metres, KEY_ORBIT_DEG_PER_S * seconds));
      return;
    }
    if (move === "in" || move === "out") {
      this.set(zoomAt(rig.pose, this.middle(), Math.exp((move === "in" ? -1 : 1) * KEY_ZOOM_PER_S * seconds), world));
      return;
    }
    const x = move === "left" ? -1 : move === "right" ? 1 : 0;
    const y = move === "down" ? -1 : move === "up" ? 1 : 0;
    if (shift) {
      const angle = KEY_ORBIT_DEG_PER_S * seconds;
      this.set(orbit(rig.pose, this.middle(), x * angle, mode() === "top" ? 0 : y * angle));
    } else {
      const px = KEY_PAN_PER_S * rig.size[1] * seconds;
      this.set(panBy(rig.pose, rig.size, [x * px, y * px], this.distance()));
    }
  }

  // ---- places ----

  private set(pose: CameraPose): void {
    const { rig, world } = this.options;
    rig.set(this.aboveGround(keepNear(pose, world)));
    this.options.invalidate();
  }

  /** Not into the ground. */
  private aboveGround(pose: CameraPose): CameraPose {
    if (pose.orthoHeightM !== null) return pose;
    const [x, y, z] = pose.eyeEnu;
    const ground = this.options.groundAt(x, y);
    if (ground === null || z >= ground + CLEARANCE_M) return pose;
    return { ...pose, eyeEnu: [x, y, ground + CLEARANCE_M] };
  }

  /** What is under the pointer: the surface, else the plane of the ground. */
  private placeAt(px: Vec2): Vec3 | null {
    const { rig, world, pick } = this.options;
    return pick(px) ?? onPlane(rig.pose, rig.size, px, world.groundM, 4 * world.sizeM);
  }

  /** What the middle of the picture shows, or a place straight ahead. */
  private middle(): Vec3 {
    const { rig, world } = this.options;
    const px: Vec2 = [rig.size[0] / 2, rig.size[1] / 2];
    return this.placeAt(px) ?? add(rig.pose.eyeEnu, scale(forward(rig.pose.rotation), world.sizeM / 2));
  }

  /** To the ground in the middle of the picture, without looking at the surface: for speeds. */
  private distance(): number {
    const { rig, world } = this.options;
    const ahead = onPlane(rig.pose, rig.size, [rig.size[0] / 2, rig.size[1] / 2], world.groundM, 4 * world.sizeM);
    return ahead === null ? world.sizeM / 2 : Math.max(1, norm(sub(ahead, rig.pose.eyeEnu)));
  }
}

function flyPose(pose: CameraPose, move: HeldKey["move"], metres: number, angleDeg: number): CameraPose {
  switch (move) {
    case "ahead":
    case "up":
    case "in":
      return flyBy(pose, 0, metres, 0);
    case "back":
    case "down":
    case "out":
      return flyBy(pose, 0, -metres, 0);
    case "aside-left":
      return flyBy(pose, -metres, 0, 0);
    case "aside-right":
      return flyBy(pose, metres, 0, 0);
    case "rise":
      return flyBy(pose, 0, 0, metres);
    case "sink":
      return flyBy(pose, 0, 0, -metres);
    case "left":
      return turn(pose, -angleDeg, 0);
    case "right":
      return turn(pose, angleDeg, 0);
    default: {
      const never: never = move;
      throw new Error(`unknown key ${String(never)}`);
    }
  }
}
