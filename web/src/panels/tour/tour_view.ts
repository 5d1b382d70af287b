// Between the view and the stops of the tour.
import type { Vec3 } from "../../base/vec.js";
import { add, sub } from "../../base/vec_math.js";
import type { CameraPose } from "../../state/app_state.js";
import { poseOf } from "../../tour/route.js";
import type { Stop, Thing } from "../../tour/types.js";
import type { PlayContext } from "../context.js";

export function goToStop({ store, scene }: Pick<PlayContext, "store" | "scene">, stop: Stop): void {
  // From straight above there is no perspective.
  if (store.get().navigation === "top") store.set({ navigation: "map" });
  const pose: CameraPose = poseOf(stop.pose);
  void scene.flyTo(pose);
}

/** From obliquely above, with some of what is around it. */
export function lookAtThing({ scene, project }: Pick<PlayContext, "scene" | "project">, { id, at }: Thing): void {
  const box = scene.boxOfThing(id) ?? { min: at, max: at };
  const around = 40 * project.gsdM + 5;
  const by: Vec3 = [around, around, around];
  void scene.frameBox(sub(box.min, by), add(box.max, by));
}
