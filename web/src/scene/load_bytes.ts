// Where the scene's files come from: the server of the page, or whatever the entry passes in.

/** The bytes of a file; rejects with an Error for the user. */
export type LoadBytes = (url: string, signal: AbortSignal) => Promise<ArrayBuffer>;

/** From the server that the page comes from. */
export async function fetchBytes(url: string, signal: AbortSignal): Promise<ArrayBuffer> {
  const response = await fetch(url, { credentials: "same-origin", signal });
  if (!response.ok) throw new Error(`the server answers ${response.status} for ${url}`);
  return response.arrayBuffer();
}
