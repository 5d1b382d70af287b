// A click's place: the mesh's point at once, the field's as soon as the engine has found it along the same ray. The engine is asked one place after
// the other, because a newer request would replace one that waits.
import { isAbort } from "../base/abort.js";
import type { Vec2, Vec3 } from "../base/vec.js";
import { add, normalize, scale } from "../base/vec_math.js";
import type { Picked, Which } from "../protocol/link_api.js";
import type { Ray } from "../scene/scene_api.js";
import type { AppState, ClipBox, SurfacePoint } from "../state/app_state.js";
import { addErrorNotice } from "../state/notices.js";
import type { ToolContext } from "./tool_context.js";

export interface Picking {
  /** Null: no mesh there. */
  readonly mesh: SurfacePoint | null;
  /** Null: the field has nothing there, or cannot be asked. Never rejects. */
  readonly field: Promise<SurfacePoint | null>;
}

/** Others ask the engine too, and theirs may replace ours. */
const TRIES = 3;

export class SurfacePicker {
  private readonly context: Pick<ToolContext, "scene" | "link" | "store">;
  private queue: Promise<unknown> = Promise.resolve();
  private readonly surveys = new WeakMap<SurfacePoint, Which>();

  constructor(context: Pick<ToolContext, "scene" | "link" | "store">) {
    this.context = context;
  }

  pick(px: Vec2): Picking {
    const { scene, store } = this.context;
    const state = store.get();
    const which = shownAt(state, px, scene.canvas.clientWidth);
    const mesh = scene.pickSurface(px);
    if (mesh !== null) this.surveys.set(mesh, which);
    if (!state.engine.connected || !state.engine.ready) return { mesh, field: Promise.resolve(null) };
    // The camera may move before it is our turn.
    const ray = scene.rayAt(px);
    const clip = state.clip.on ? state.clip : null;
    const field = this.queue.then(() => this.ask(ray, clip, which));
    this.queue = field;
    return { mesh, field };
  }

  /** On which survey these points lie, as it was shown when they were clicked; null: on both. */
  surveyOf(points: readonly SurfacePoint[]): Which | null {
    const first = points[0];
    const survey = (point: SurfacePoint) => this.surveys.get(point) ?? "main";
    if (first === undefined) return "main";
    return points.every((point) => survey(point) === survey(first)) ? survey(first) : null;
  }

  /** Resolves when nothing is being asked. */
  async idle(): Promise<void> {
    for (let last: Promise<unknown> | null = null; last !== this.queue; ) {
      last = this.queue;
      await last;
    }
  }

  private async ask(ray: Ray, clip: ClipBox | null, which: Which): Promise<SurfacePoint | null> {
    const part = clip === null ? { startM: 0, endM: Number.POSITIVE_INFINITY } : insideBox(ray, clip);
    if (part === null) return null;
    for (let attempt = 1; ; attempt += 1) {
      try {
        const picked = await this.context.link.pick(startingAt(ray, part.startM), which);
        const point = fieldPoint(ray, part.startM, part.endM, picked);
        if (point !== null) this.surveys.set(point, which);
        return point;
      } catch (error) {
        if (isAbort(error) && attempt < TRIES) continue;
        addErrorNotice(this.context.store, "The exact point was not found, that of the surface is used", error);
        return null;
      }
    }
  }
}

/** Left of the swipe's line the earlier project is shown, so its field is asked. */
export function shownAt({ swipe }: Pick<AppState, "swipe">, px: Vec2, widthPx: number): Which {
  return swipe.on && px[0] < swipe.at * widthPx ? "before" : "main";
}

/** The part of the ray that is in the box: what is outside is not shown. Null: none. */
export function insideBox(
  { originEnu, direction }: Pick<Ray, "originEnu" | "direction">,
  { min, max }: Pick<ClipBox, "min" | "max">,
): { readonly startM: number; readonly endM: number } | null {
  const d = normalize(direction);
  let startM = 0;
  let endM = Number.POSITIVE_INFINITY;
  for (const axis of [0, 1, 2] as const) {
    if (d[axis] === 0) {
      if (originEnu[axis] < min[axis] || originEnu[axis] > max[axis]) return null;
      continue;
    }
    const a = (min[axis] - originEnu[axis]) / d[axis];
    const b = (max[axis] - originEnu[axis]) / d[axis];
    startM = Math.max(startM, Math.min(a, b));
    endM = Math.min(endM, Math.max(a, b));
  }
  return startM < endM ? { startM, endM } : null;
}

/** The same ray from further on; a pixel has grown until there. */
function startingAt(ray: Ray, startM: number): Ray {
  if (startM === 0) return ray;
  return {
    originEnu: add(ray.originEnu, scale(normalize(ray.direction), startM)),
    direction: ray.direction,
    pixelPitch: ray.pixelPitch,
    pixelWidthM: ray.pixelWidthM + ray.pixelPitch * startM,
  };
}

function fieldPoint(ray: Ray, startM: number, endM: number, picked: Picked): SurfacePoint | null {
  const depthM = startM + picked.depthM;
  if (!picked.hit || !picked.point.every(Number.isFinite) || !Number.isFinite(depthM) || depthM > endM) return null;
  const direction: Vec3 = normalize(ray.direction);
  return {
    enu: picked.point,
    direction,
    spreadM: picked.spreadM !== null && picked.spreadM >= 0 ? picked.spreadM : null,
    pixelM: ray.pixelWidthM + ray.pixelPitch * depthM,
    source: "field",
  };
}
