// Base64 (RFC 4648, with padding) to bytes. Browsers' atob() makes a text of the whole first, which doubles the memory of files of megabytes.

const INVALID = 0x40;
const CODES = new Uint8Array(256).fill(INVALID);
for (const [value, letter] of [..."ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"].entries()) {
  CODES[letter.charCodeAt(0)] = value;
}

/** Throws an Error when the text is not base64. */
export function bytesFromBase64(text: string): Uint8Array<ArrayBuffer> {
  const padding = text.endsWith("==") ? 2 : text.endsWith("=") ? 1 : 0;
  if (text.length % 4 !== 0) throw new Error("it is not base64: its length is not a multiple of 4");
  const bytes = new Uint8Array((text.length / 4) * 3 - padding);
  const code = (at: number): number => {
    const letter = text.charCodeAt(at);
    return letter > 255 ? INVALID : (CODES[letter] ?? INVALID);
  };
  // What is wrong is looked for once at the end.
  let seen = 0;
  let out = 0;
  const whole = padding === 0 ? text.length : text.length - 4;
  for (let at = 0; at < whole; at += 4) {
    const [a, b, c, d] = [code(at), code(at + 1), code(at + 2), code(at + 3)];
    seen |= a | b | c | d;
    bytes[out] = (a << 2) | (b >> 4);
    bytes[out + 1] = (b << 4) | (c >> 2);
    bytes[out + 2] = (c << 6) | d;
    out += 3;
  }
  if (padding > 0) {
    const [a, b, c] = [code(whole), code(whole + 1), padding === 1 ? code(whole + 2) : 0];
    // Bits beyond the last byte must be 0, so that each file has one text.
    seen |= a | b | c | ((padding === 1 ? c & 3 : b & 15) !== 0 ? INVALID : 0);
    bytes[out] = (a << 2) | (b >> 4);
    if (padding === 1) bytes[out + 1] = (b << 4) | (c >> 2);
  }
  if ((seen & INVALID) !== 0) throw new Error("it is not base64: it has characters that do not belong there");
  return bytes;
}
