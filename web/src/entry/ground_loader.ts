// What playing a tour needs of the ground: its heights and where its picture lies, from the surface model of the project.
import type { LoadBytes } from "../scene/load_bytes.js";
import { parseTerrain } from "../scene/terrain_grid.js";
import type { Project } from "../state/project.js";
import type { Ground } from "../tools/tour_playback.js";
import { heightsFromTerrain } from "../tour/terrain_heights.js";
import { groundMap } from "./ground_map.js";

/** `pictureUrl`: what the page shows for the address of a picture; null: it is not there. */
export function groundLoader(
  { terrain, orthophoto }: Pick<Project, "terrain" | "orthophoto">,
  loadBytes: LoadBytes,
  pictureUrl: (url: string) => Promise<string | null>,
): () => Promise<Ground> {
  return async () => {
    if (terrain === null) return { heights: null, map: null };
    const picture = orthophoto === null ? Promise.resolve(null) : pictureUrl(orthophoto);
    const grid = parseTerrain(await loadBytes(terrain, new AbortController().signal));
    return { heights: heightsFromTerrain(grid), map: groundMap(grid, await picture) };
  };
}
