// Which places of the scene are at places of the canvas: what a click meets, where one looks, how high the ground is.
import type { Vec2, Vec3 } from "../base/vec.js";
import { add, dot, scale } from "../base/vec_math.js";
import { anglesOfPose, forward } from "../geo/camera.js";
import type { SurfacePoint } from "../state/app_state.js";
import type { CameraRig } from "./camera_rig.js";
import { pickSurfaces } from "./picking.js";
import type { ViewReadout } from "./readout.js";
import type { Ray } from "./scene_api.js";
import type { Stage } from "./stage.js";
import { pixelSizeM } from "./view_math.js";
import { sceneFromEnu, type World } from "./world.js";

export interface PlacesOptions {
  readonly rig: CameraRig;
  readonly stage: Stage;
  readonly world: World;
  /** Null, or where the earlier project ends, 0 to 1 of the width. */
  swipeAt(): number | null;
}

export class Places {
  private readonly options: PlacesOptions;

  constructor(options: PlacesOptions) {
    this.options = options;
  }

  surface(px: Vec2): SurfacePoint | null {
    const ray = this.options.rig.rayAt(px);
    const t = this.surfaceAt(px, ray);
    return t === null ? null : pointAlong(ray, t);
  }

  /** The surface, or a model in front of it whose distance along the ray is given. */
  surfaceOr(px: Vec2, modelT: number | null): SurfacePoint | null {
    const ray = this.options.rig.rayAt(px);
    const nearest = Math.min(this.surfaceAt(px, ray) ?? Number.POSITIVE_INFINITY, modelT ?? Number.POSITIVE_INFINITY);
    return Number.isFinite(nearest) ? pointAlong(ray, nearest) : null;
  }

  building(px: Vec2): number | null {
    const { rig, stage, world } = this.options;
    // Buildings of the earlier project are not shown.
    if (this.isBefore(px)) return null;
    const { originEnu, direction } = rig.rayAt(px);
    return stage.buildings.pick(sceneFromEnu(world, originEnu), direction, stage.clipBox);
  }

  /** What the middle of the view shows, or a place ahead. */
  focus(): Vec3 {
    const { rig, world } = this.options;
    const middle: Vec2 = [rig.size[0] / 2, rig.size[1] / 2];
    return this.surface(middle)?.enu ?? add(rig.pose.eyeEnu, scale(forward(rig.pose.rotation), world.sizeM / 2));
  }

  groundAt(x: number, y: number): number | null {
    const { stage, world } = this.options;
    const topM = world.boxEnu.max[2] + world.sizeM;
    const t = pickSurfaces(stage.surfaces("main"), sceneFromEnu(world, [x, y, topM]), [0, 0, -1], null);
    return t === null ? null : topM - t;
  }

  readout(fps: number): ViewReadout {
    const { rig, stage, world } = this.options;
    const { yawDeg, pitchDeg } = anglesOfPose(rig.pose.rotation);
    const ray = rig.rayAt([rig.size[0] / 2, rig.size[1] / 2]);
    const t = pickSurfaces(stage.surfaces("main"), sceneFromEnu(world, ray.originEnu), ray.direction, null);
    const depthM = t === null ? null : t * dot(ray.direction, forward(rig.pose.rotation));
    const metresPerPx =
      rig.pose.orthoHeightM === null && depthM === null ? null : pixelSizeM(rig.pose, rig.size, depthM ?? 0);
    return { headingDeg: yawDeg, pitchDeg, metresPerPx, fps };
  }

  private surfaceAt(px: Vec2, ray: Ray): number | null {
    const { stage, world } = this.options;
    const side = this.isBefore(px) ? "before" : "main";
    return pickSurfaces(stage.surfaces(side), sceneFromEnu(world, ray.originEnu), ray.direction, stage.clipBox);
  }

  private isBefore(px: Vec2): boolean {
    const { rig, swipeAt } = this.options;
    const at = swipeAt();
    return at !== null && px[0] < at * rig.size[0];
  }
}

function pointAlong(ray: Ray, t: number): SurfacePoint {
  return {
    enu: add(ray.originEnu, scale(ray.direction, t)),
    direction: ray.direction,
    spreadM: null,
    pixelM: ray.pixelWidthM + ray.pixelPitch * t,
    source: "mesh",
  };
}
