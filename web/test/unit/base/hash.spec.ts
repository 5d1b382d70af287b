// Hashes against the published values of FNV-1a, and against its definition in whole numbers.
import assert from "node:assert/strict";
import test from "node:test";
import { hashHex } from "../../../src/base/hash.js";

const of = (text: string): string => hashHex(new TextEncoder().encode(text));

test("a hash is that of Fowler, Noll and Vo", () => {
  assert.equal(of(""), "cbf29ce484222325");
  assert.equal(of("a"), "af63dc4c8601ec8c");
  assert.equal(of("foobar"), "85944171f73967e8");
});

test("carries go through all digits", () => {
  const bytes = Uint8Array.from({ length: 5000 }, (_, i) => (i * i + 7 * i) % 256);
  let expected = 14695981039346656037n;
  for (const byte of bytes) expected = BigInt.asUintN(64, (expected ^ BigInt(byte)) * 1099511628211n);
  assert.equal(hashHex(bytes), expected.toString(16).padStart(16, "0"));
});
