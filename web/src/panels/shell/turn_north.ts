// Turns the view so that north is up.
import { northUp } from "../../geo/camera.js";
import type { AppContext } from "../context.js";

export function turnNorthUp({ scene }: Pick<AppContext, "scene">): Promise<void> {
  const { clientWidth: w, clientHeight: h } = scene.canvas;
  return scene.flyTo(northUp(scene.pose(), scene.pickSurface([w / 2, h / 2])?.enu ?? null));
}
