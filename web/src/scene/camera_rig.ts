// The camera: its pose in doubles, the three.js cameras that follow it, and what moved since the last frame.
import { type Camera, OrthographicCamera, PerspectiveCamera } from "three";
import type { Vec2 } from "../base/vec.js";
import { quatNormalize } from "../base/vec_math.js";
import { threeQuaternion } from "../geo/camera.js";
import type { CameraPose } from "../state/app_state.js";
import type { Ray } from "./scene_api.js";
import { depthRange, projectPoint, rayAt, type Size } from "./view_math.js";
import { type Box, sceneFromEnu, type World } from "./world.js";

function usable(pose: CameraPose): boolean {
  const ortho = pose.orthoHeightM;
  return (
    pose.eyeEnu.every(Number.isFinite) &&
    pose.rotation.every(Number.isFinite) &&
    Number.isFinite(pose.fovyDeg) &&
    (ortho === null || (Number.isFinite(ortho) && ortho > 0))
  );
}

export function samePose(a: CameraPose, b: CameraPose): boolean {
  return (
    a === b ||
    (a.fovyDeg === b.fovyDeg &&
      a.orthoHeightM === b.orthoHeightM &&
      a.eyeEnu.every((value, i) => value === b.eyeEnu[i]) &&
      a.rotation.every((value, i) => value === b.rotation[i]))
  );
}

export class CameraRig {
  private readonly world: World;
  private readonly perspective = new PerspectiveCamera();
  private readonly orthographic = new OrthographicCamera();
  private now: CameraPose;
  private canvas: Size = [1, 1];
  private changes = 0;

  constructor(world: World, pose: CameraPose) {
    this.world = world;
    this.now = pose;
  }

  get pose(): CameraPose {
    return this.now;
  }

  /** CSS pixels. */
  get size(): Size {
    return this.canvas;
  }

  /** Grows when the picture of a still scene changes. */
  get version(): number {
    return this.changes;
  }

  /** Poses with numbers that are none are ignored. */
  set(pose: CameraPose): void {
    if (!usable(pose) || samePose(pose, this.now)) return;
    const fovyDeg = Math.min(150, Math.max(1, pose.fovyDeg));
    this.now = { ...pose, fovyDeg, rotation: quatNormalize(pose.rotation) };
    this.changes += 1;
  }

  resize(size: Size): void {
    if (size[0] === this.canvas[0] && size[1] === this.canvas[1]) return;
    this.canvas = size;
    this.changes += 1;
  }

  rayAt(px: Vec2): Ray {
    return rayAt(this.now, this.canvas, px);
  }

  project(enu: readonly [number, number, number]): Vec2 | null {
    return projectPoint(this.now, this.canvas, enu);
  }

  /** The three.js camera of the present pose; near and far hold `boxEnu`. */
  update(boxEnu: Box): Camera {
    const { near, far } = depthRange(this.now, boxEnu);
    const aspect = this.canvas[0] / Math.max(1, this.canvas[1]);
    let camera: PerspectiveCamera | OrthographicCamera;
    if (this.now.orthoHeightM === null) {
      camera = this.perspective;
      camera.fov = this.now.fovyDeg;
      camera.aspect = aspect;
    } else {
      camera = this.orthographic;
      const half = this.now.orthoHeightM / 2;
      camera.top = half;
      camera.bottom = -half;
      camera.left = -half * aspect;
      camera.right = half * aspect;
    }
    camera.near = near;
    camera.far = far;
    camera.position.set(...sceneFromEnu(this.world, this.now.eyeEnu));
    camera.quaternion.set(...threeQuaternion(this.now.rotation));
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
    return camera;
  }
}
