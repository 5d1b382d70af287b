// Pictures and raw deflate by the browser's own decoders.

/** Without these options the browser may change the values, and what is lossless must arrive bit by bit. */
const AS_THEY_ARE: ImageBitmapOptions = { colorSpaceConversion: "none", premultiplyAlpha: "none" };

export type PictureType = "image/jpeg" | "image/png";

/** The caller closes it. */
export function decodePicture(bytes: Uint8Array<ArrayBuffer>, type: PictureType): Promise<ImageBitmap> {
  return createImageBitmap(new Blob([bytes], { type }), AS_THEY_ARE);
}

/** Stops at one byte more than expected, so that a damaged file cannot fill the memory. */
export async function inflate(packed: Uint8Array<ArrayBuffer>, bytes: number): Promise<Uint8Array<ArrayBuffer>> {
  const out = new Uint8Array(bytes);
  const reader = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  let filled = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (filled + value.byteLength > bytes) {
      await reader.cancel();
      throw new Error(`the depth is longer than ${bytes} bytes`);
    }
    out.set(value, filled);
    filled += value.byteLength;
  }
  return out.subarray(0, filled);
}
