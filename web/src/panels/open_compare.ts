// Jumps into a photo's pose and lays the photo over the view.
import type { Photo } from "../state/project.js";
import type { AppContext } from "./context.js";
import { photoPose } from "./photo_pose.js";

export async function openCompare({ scene, store, project }: AppContext, photo: Photo): Promise<void> {
  await scene.flyTo(photoPose(project, photo));
  store.set({ compare: { photo: photo.index, split: 0.5 } });
}
