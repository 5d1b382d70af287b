// Loads the description of the project from the server.
import { CheckError, parseJson } from "../base/check.js";
import type { Project } from "../state/project.js";
import { readProject } from "./project_reader.js";

export const NO_SESSION = "this tab has no session: open the newest link that the program printed";
export const SERVER_GONE = "the server does not answer: is `skyquilt view` still running?";

/** A GET or PUT of this server; its errors are for the user. The answer may still be a 404. */
export async function request(url: string, init: RequestInit = {}): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(url, { cache: "no-store", credentials: "same-origin", ...init });
  } catch (error) {
    if (error instanceof Error && error.name === "AbortError") throw error;
    throw new Error(SERVER_GONE);
  }
  if (response.status === 403) throw new Error(NO_SESSION);
  return response;
}

/** Throws an Error whose message is for the user. */
export async function loadProject(): Promise<Project> {
  const response = await request("/data/project.json");
  const text = await response.text().catch(() => {
    throw new Error(SERVER_GONE);
  });
  if (!response.ok) {
    const said = text.trim().slice(0, 300);
    throw new Error(`the server could not describe the project (${response.status})${said === "" ? "" : `: ${said}`}`);
  }
  try {
    return readProject(parseJson(text, "project.json"));
  } catch (error) {
    if (!(error instanceof CheckError)) throw error;
    throw new Error(
      `project.json: ${error.message}. This page and the program may be of different versions: reload the page`,
    );
  }
}
