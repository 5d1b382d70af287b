import assert from "node:assert/strict";
import test from "node:test";
import { bytesFromBase64 } from "../../../src/base/base64.js";

test("bytes of any length come back", () => {
  for (let length = 0; length < 70; length += 1) {
    const bytes = Uint8Array.from({ length }, (_, i) => (i * 97 + length * 31) % 256);
    const decoded = bytesFromBase64(Buffer.from(bytes).toString("base64"));
    assert.deepEqual(decoded, bytes);
    assert.equal(decoded.buffer.byteLength, length);
  }
});

test("what is not base64 is refused", () => {
  for (const text of [
    "A",
    "AAA",
    "AAAAA",
    "AA=A",
    "A===",
    "=AAA",
    "AA A",
    "AAA\u0141",
    "AAAA=",
    "AB==",
    "AAB=",
    "AA\n=",
    "AA-_",
  ]) {
    assert.throws(() => bytesFromBase64(text), /not base64/, JSON.stringify(text));
  }
});
