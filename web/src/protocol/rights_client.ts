// What this session may save: rights.json.
import { asBoolean, asObject, parseJson } from "../base/check.js";
import { USUAL_RIGHTS } from "../state/initial.js";
import type { Rights } from "../state/tour_state.js";
import { request } from "./project_client.js";

/** Throws CheckError. */
export function readRights(value: unknown): Rights {
  const rights = asObject(value, "");
  return { documents: asBoolean(rights.documents, "documents"), tour: asBoolean(rights.tour, "tour") };
}

/** Throws an Error whose message is for the user. */
export async function loadRights(): Promise<Rights> {
  const response = await request("/data/rights.json");
  if (response.status === 404) return USUAL_RIGHTS;
  if (!response.ok) throw new Error(`the server could not say what may be changed (${response.status})`);
  return readRights(parseJson(await response.text(), "rights.json"));
}
