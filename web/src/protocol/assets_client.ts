// Uploads pictures and models of the tour, under the digest of their bytes.
import { AbortError, errorText } from "../base/abort.js";
import type { NamedAsset } from "../tour/edit_assets.js";
import { usableLine } from "../tour/text_rules.js";
import { NO_SESSION, SERVER_GONE } from "./project_client.js";

export const LARGEST_ASSET_BYTES = 50 * 1024 * 1024;
const MOST_TEXT = 300;

export type AssetKind = "picture" | "model";
/** What the server takes, by the first bytes of the file: names may lie. */
const STARTS: readonly { readonly kind: AssetKind; readonly type: string; readonly bytes: readonly number[] }[] = [
  { kind: "picture", type: "png", bytes: [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a] },
  { kind: "picture", type: "jpg", bytes: [0xff, 0xd8, 0xff] },
  { kind: "model", type: "glb", bytes: [0x67, 0x6c, 0x54, 0x46] },
];
const WANTED: Readonly<Record<AssetKind, string>> = { picture: "a PNG or JPEG picture", model: "a model as GLB file" };

export function assetUrl(file: string): string {
  return `/data/tour/assets/${file}`;
}

/** Ending of the asset's name. Throws an Error for the user. */
export function assetType(bytes: Uint8Array, kind: AssetKind): string {
  const found = STARTS.find((start) => start.kind === kind && start.bytes.every((byte, i) => bytes[i] === byte));
  if (found === undefined) throw new Error(`this is not ${WANTED[kind]}`);
  return found.type;
}

/** `send` moves the bytes; tests replace it. Throws an Error whose message is for the user. */
export async function uploadAsset(
  file: Blob & { readonly name: string },
  kind: AssetKind,
  onProgress: (fraction: number) => void,
  send: typeof putBytes = putBytes,
): Promise<NamedAsset> {
  if (file.size > LARGEST_ASSET_BYTES) {
    throw new Error(`it has ${(file.size / 1024 / 1024).toFixed(1)} MiB, and at most 50 MiB can be uploaded`);
  }
  if (file.size === 0) throw new Error("it is empty");
  const bytes = await file.arrayBuffer().catch((error: unknown) => {
    throw new Error(`it could not be read: ${errorText(error)}`);
  });
  const type = assetType(new Uint8Array(bytes), kind);
  const name = `${await sha256(bytes)}.${type}`;
  await send(assetUrl(name), bytes, onProgress);
  return { file: name, name: usableLine(file.name) ?? `${kind}.${type}`, bytes: bytes.byteLength };
}

/** 64 lower-case hexadecimal digits. */
export async function sha256(bytes: ArrayBuffer): Promise<string> {
  // Browsers have it only for pages that nobody between could have changed.
  if (globalThis.crypto?.subtle === undefined) {
    throw new Error("uploading needs this page over https, or from 127.0.0.1 as the program prints its link");
  }
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes));
  return [...digest].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** fetch() tells no progress of what it sends. */
function putBytes(url: string, bytes: ArrayBuffer, onProgress: (fraction: number) => void): Promise<void> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("PUT", url);
    request.setRequestHeader("Content-Type", "application/octet-stream");
    request.upload.onprogress = ({ loaded, total }) => {
      if (total > 0) onProgress(loaded / total);
    };
    request.onerror = () => reject(new Error(SERVER_GONE));
    request.onabort = () => reject(new AbortError());
    request.onload = () => {
      const { status } = request;
      const said = request.responseText.trim().slice(0, MOST_TEXT);
      if (status >= 200 && status < 300) resolve();
      else if (said !== "") reject(new Error(said));
      else reject(new Error(status === 403 ? NO_SESSION : `the server answered ${status}`));
    };
    request.send(bytes);
  });
}
