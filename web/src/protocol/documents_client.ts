// Loads and saves the documents of the project: measurements.geojson, gcp.json, camera_path.json.
import type { DocumentFile } from "../state/persistence.js";
import { request } from "./project_client.js";

/** The server takes no more. */
const LARGEST_BYTES = 1024 * 1024;
const MOST_TEXT = 300;

/** The file's text; null: there is none yet. Throws an Error whose message is for the user. */
export async function loadDocument(file: DocumentFile): Promise<string | null> {
  const response = await request(`/data/${file}`);
  // Browsers write every 404 on the console, so a server may say "nothing" by 204.
  if (response.status === 404 || response.status === 204) return null;
  if (!response.ok) throw new Error(await reason(response));
  return response.text();
}

/** `keepalive`: for a page that is being left; browsers then send at most 64 KiB. Throws an Error whose message is for the user. */
export async function saveDocument(file: DocumentFile, text: string, keepalive = false): Promise<void> {
  const body = new TextEncoder().encode(text);
  if (body.byteLength > LARGEST_BYTES) {
    throw new Error(
      `it has ${(body.byteLength / LARGEST_BYTES).toFixed(1)} MiB, and at most 1 MiB can be saved: delete some of it`,
    );
  }
  const type = file.endsWith(".geojson") ? "application/geo+json" : "application/json";
  const response = await request(`/data/${file}`, {
    method: "PUT",
    headers: { "Content-Type": type },
    body,
    keepalive,
  });
  if (!response.ok) throw new Error(await reason(response));
}

async function reason(response: Response): Promise<string> {
  const text = await response.text().catch(() => "");
  const said = text.trim().slice(0, MOST_TEXT);
  return said === "" ? `the server answered ${response.status}` : said;
}
