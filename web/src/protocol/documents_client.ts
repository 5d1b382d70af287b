// Loads and saves the documents of the project: measurements.geojson, gcp.json, camera_path.json.
import type { DocumentFile } from "../state/persistence.js";
import { request } from "./project_client.js";

/** The server takes no more. */
const LARGEST_BYTES = 1024 * 1024;
/** Browsers refuse requests that are to outlive the page and are longer than 64 KiB, all of them together: longer ones are sent as usual. */
const MOST_KEPT_ALIVE_BYTES = 60 * 1024;
const MOST_TEXT = 300;

/** A file as it is in the project now. */
export interface LoadedDocument {
  /** Null: there is none yet. */
  readonly text: string | null;
  /** Names this content, for saving; null: the server gave none. */
  readonly tag: string | null;
}

export interface SaveOptions {
  /** What the file must still be: tags, separated by commas; null: anything. */
  readonly ifMatch: string | null;
  /** For a page that is being left: the request outlives it, unless it is too long. */
  readonly keepalive?: boolean;
}

/** Nothing was saved: the file is no longer the one that was loaded or saved here. */
export class ChangedElsewhere extends Error {}

/** Throws an Error whose message is for the user. */
export async function loadDocument(file: DocumentFile): Promise<LoadedDocument> {
  const response = await request(`/data/${file}`);
  // Browsers write every 404 on the console, so a server may say "nothing" by 204.
  if (response.status === 404 || response.status === 204) return { text: null, tag: tagOf(response) };
  if (!response.ok) throw new Error(await reason(response));
  return { text: await response.text(), tag: tagOf(response) };
}

/** Returns the tag of what is saved now. Throws ChangedElsewhere, or an Error whose message is for the user. */
export async function saveDocument(file: DocumentFile, text: string, options: SaveOptions): Promise<string | null> {
  const body = new TextEncoder().encode(text);
  if (body.byteLength > LARGEST_BYTES) {
    throw new Error(
      `it has ${(body.byteLength / LARGEST_BYTES).toFixed(1)} MiB, and at most 1 MiB can be saved: delete some of it`,
    );
  }
  const type = file.endsWith(".geojson") ? "application/geo+json" : "application/json";
  const response = await request(`/data/${file}`, {
    method: "PUT",
    headers: { "Content-Type": type, ...(options.ifMatch === null ? {} : { "If-Match": options.ifMatch }) },
    body,
    keepalive: options.keepalive === true && body.byteLength <= MOST_KEPT_ALIVE_BYTES,
  });
  if (response.status === 412) throw new ChangedElsewhere(await reason(response));
  if (!response.ok) throw new Error(await reason(response));
  return tagOf(response);
}

/** The control points of a gcp_list.txt as gcp.json; nothing is saved. Throws an Error whose message is for the user. */
export async function convertGcpList(list: string): Promise<string> {
  const headers = { "Content-Type": "text/plain" };
  const response = await request("/data/gcp_list.txt", { method: "PUT", headers, body: list });
  if (!response.ok) throw new Error(await reason(response));
  return response.text();
}

/** A proxy that compresses makes the tag a weak one, which is none for If-Match. */
function tagOf(response: Response): string | null {
  return response.headers.get("ETag")?.replace(/^W\//, "") ?? null;
}

async function reason(response: Response): Promise<string> {
  const text = await response.text().catch(() => "");
  const said = text.trim().slice(0, MOST_TEXT);
  return said === "" ? `the server answered ${response.status}` : said;
}
