// FNV-1a of 64 bits, which the server takes for the tags of documents. In four digits of 16 bits, because a product of two such fits into a number.

/** As 16 hexadecimal digits. */
export function hashHex(bytes: Uint8Array): string {
  // 14695981039346656037, the lowest digit first.
  let [a, b, c, d] = [0x2325, 0x8422, 0x9ce4, 0xcbf2];
  for (const byte of bytes) {
    a ^= byte;
    // Times 1099511628211, which is 2^40 + 0x1b3.
    const first = a * 0x1b3;
    const second = b * 0x1b3 + (first >>> 16);
    const third = c * 0x1b3 + (a << 8) + (second >>> 16);
    d = (d * 0x1b3 + (b << 8) + (third >>> 16)) & 0xffff;
    c = third & 0xffff;
    b = second & 0xffff;
    a = first & 0xffff;
  }
  return [d, c, b, a].map((digit) => digit.toString(16).padStart(4, "0")).join("");
}
