// What playing a tour needs of the ground: its heights and where its picture lies, from the surface model of the project.
import { request } from "../protocol/project_client.js";
import { parseTerrain } from "../scene/terrain_grid.js";
import type { Project } from "../state/project.js";
import type { Ground } from "../tools/tour_playback.js";
import { heightsFromTerrain } from "../tour/terrain_heights.js";
import { groundMap } from "./ground_map.js";

export function groundLoader(project: Pick<Project, "terrain" | "orthophoto">): () => Promise<Ground> {
  return async () => {
    if (project.terrain === null) return { heights: null, map: null };
    const response = await request(project.terrain);
    if (!response.ok) throw new Error(`the surface model was not loaded (${response.status})`);
    const terrain = parseTerrain(await response.arrayBuffer());
    return { heights: heightsFromTerrain(terrain), map: groundMap(terrain, project.orthophoto) };
  };
}
