// Loads the buildings from the server.
import { CheckError, parseJson } from "../base/check.js";
import type { BuildingSet } from "../state/buildings.js";
import { readBuildings } from "./buildings_reader.js";
import { request, SERVER_GONE } from "./project_client.js";

/** Throws an Error whose message is for the user. */
export async function loadBuildings(url: string): Promise<BuildingSet> {
  const response = await request(url);
  const text = await response.text().catch(() => {
    throw new Error(SERVER_GONE);
  });
  if (!response.ok) throw new Error(`the server answers ${response.status}: ${text.trim().slice(0, 300)}`);
  try {
    return readBuildings(parseJson(text, "buildings.json"));
  } catch (error) {
    if (!(error instanceof CheckError)) throw error;
    throw new Error(`buildings.json: ${error.message}. Run \`skyquilt buildings\` again with --restart`);
  }
}
