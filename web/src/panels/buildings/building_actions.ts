// What can be done with a building: look at it, find the photos that see it, copy its measures.
import type { Vec3 } from "../../base/vec.js";
import type { SurfacePoint } from "../../state/app_state.js";
import { type Building, boxOfBuilding, topOfBuilding } from "../../state/buildings.js";
import { buildingsCsv } from "../../state/buildings_csv.js";
import { addErrorNotice, addNotice } from "../../state/notices.js";
import type { AppContext } from "../context.js";
import { buildingText } from "./building_text.js";

const ABOVE_M = 5;

/** With some room around it. On a phone the panel would hide it; a tap on the building opens it again. */
export function lookAtBuilding({ scene, store }: AppContext, building: Building): void {
  if (window.matchMedia("(max-width: 720px)").matches) store.set({ panel: null });
  const { min, max } = boxOfBuilding(building);
  const margin = 0.7 * Math.max(max[0] - min[0], max[1] - min[1], 1);
  const low: Vec3 = [min[0] - margin, min[1] - margin, min[2]];
  const high: Vec3 = [max[0] + margin, max[1] + margin, max[2]];
  void scene.frameBox(low, high);
}

/** The photos that see the middle of its roof, in the panel of photos. */
export async function showPhotosOf({ store, link, project }: AppContext, building: Building): Promise<void> {
  const top = topOfBuilding(building);
  const down: Vec3 = [0, 0, -1];
  // From straight above, as the field has the roof there: the model may lie a little under it, where no photo sees it.
  const ray = { originEnu: [top[0], top[1], top[2] + ABOVE_M] as const, direction: down, pixelPitch: 0 };
  const { ready, connected } = store.get().engine;
  try {
    const picked = ready && connected ? await link.pick({ ...ray, pixelWidthM: project.gsdM }) : null;
    const found = picked?.hit === true && picked.point.every(Number.isFinite) ? picked : null;
    const point: SurfacePoint = {
      enu: found?.point ?? top,
      direction: down,
      spreadM: found?.spreadM ?? null,
      pixelM: project.gsdM,
      source: found === null ? "mesh" : "field",
    };
    const { checked, photos } = await link.photosAt(point.enu);
    store.set({ sights: { point, checked, photos }, panel: "photos" });
  } catch (error) {
    addErrorNotice(store, `Photos that see building ${building.id} were not found`, error);
  }
}

export async function copyBuilding({ store, project }: AppContext, building: Building): Promise<void> {
  const { set } = store.get().buildings;
  if (set === null) return;
  await copy(store, buildingText(building, set, project), `Building ${building.id} was copied.`);
}

/** In the order of the table. */
export async function copyTable({ store, project }: AppContext, buildings: readonly Building[]): Promise<void> {
  const metric = store.get().buildings.set?.metric === true;
  await copy(store, buildingsCsv(buildings, metric, project), "The table was copied as CSV.");
}

async function copy(store: AppContext["store"], text: string, done: string): Promise<void> {
  try {
    // Browsers offer the clipboard only to pages of this computer or by HTTPS.
    await navigator.clipboard.writeText(text);
    addNotice(store, "info", done);
  } catch {
    addNotice(store, "info", "The browser did not allow copying: take buildings.csv from the list of files.");
  }
}
