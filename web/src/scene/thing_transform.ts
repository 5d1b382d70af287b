// Where a model stands: from its file's axes (x, y up, z, metres) into the scene. In doubles and without three.js.
import { transformPoint } from "../base/vec_math.js";
import type { ModelThing } from "./thing.js";
import { cornersOf } from "./view_math.js";
import { type Box, multiply, translation, type World } from "./world.js";

/** 16 numbers row by row. */
export function enuFromModel({ at, yawDeg, scale }: Pick<ModelThing, "at" | "yawDeg" | "scale">): number[] {
  const yaw = (yawDeg * Math.PI) / 180;
  const [c, s] = [scale * Math.cos(yaw), scale * Math.sin(yaw)];
  // Columns: the file's x is east turned by yaw, its y is up, its z is south turned by yaw.
  return [c, 0, -s, at[0], -s, 0, -c, at[1], 0, scale, 0, at[2], 0, 0, 0, 1];
}

export function sceneFromModel(world: World, thing: Pick<ModelThing, "at" | "yawDeg" | "scale">): number[] {
  const [x, y, z] = world.anchor;
  return multiply(translation([-x, -y, -z]), enuFromModel(thing));
}

/** The box with its sides along the axes that holds the turned one. */
export function boxThrough(matrix: readonly number[], box: Box): Box {
  const corners = cornersOf(box).map((corner) => transformPoint(matrix, corner));
  const axis = (i: 0 | 1 | 2) => corners.map((corner) => corner[i]);
  return {
    min: [Math.min(...axis(0)), Math.min(...axis(1)), Math.min(...axis(2))],
    max: [Math.max(...axis(0)), Math.max(...axis(1)), Math.max(...axis(2))],
  };
}
