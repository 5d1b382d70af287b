// Jumps into a photo's pose and lays the photo over the view.
import { norm, sub } from "../../base/vec_math.js";
import { photoPose } from "../../state/photo_pose.js";
import type { Photo } from "../../state/project.js";
import type { AppContext } from "../context.js";

/** Nearer is there. */
const NEAR_M = 0.001;

/** The photo that was asked for last. */
let newest: symbol | null = null;

export async function openCompare(
  { scene, store, project }: Pick<AppContext, "scene" | "store" | "project">,
  photo: Photo,
): Promise<void> {
  const own = Symbol(photo.name);
  newest = own;
  const pose = photoPose(project, photo);
  await scene.flyTo(pose);
  // A flight that was given up has ended elsewhere: the person wants to look at something else.
  if (own !== newest || !(norm(sub(scene.pose().eyeEnu, pose.eyeEnu)) <= NEAR_M)) return;
  store.set({ compare: { photo: photo.index, split: 0.5 } });
}
