import assert from "node:assert/strict";
import test from "node:test";
import * as check from "../../../src/base/check.js";

function fails(run: () => unknown, message: RegExp): void {
  assert.throws(run, (error: unknown) => error instanceof check.CheckError && message.test(error.message));
}

test("numbers are finite numbers, nothing else", () => {
  assert.equal(check.asNumber(3.5, "x"), 3.5);
  for (const wrong of ["12", "12abc", Number.NaN, Number.POSITIVE_INFINITY, null, undefined, [1], {}, true]) {
    fails(() => check.asNumber(wrong, "a.b"), /^a\.b: a number expected/);
  }
  fails(() => check.asNumber(-1, "x", 0), /at least 0/);
  fails(() => check.asNumber(11, "x", 0, 10), /at most 10/);
  assert.equal(check.asInteger(3, "x"), 3);
  fails(() => check.asInteger(3.7, "x"), /whole number/);
  fails(() => check.asInteger(2 ** 53, "x"), /at most/);
});

test("objects are not lists, lists not objects, null neither", () => {
  assert.deepEqual(check.asObject({ a: 1 }, "x"), { a: 1 });
  fails(() => check.asObject([], "x"), /an object expected, found a list of 0/);
  fails(() => check.asObject(null, "x"), /found null/);
  fails(() => check.asArray({ length: 3 }, "x"), /a list expected/);
  fails(() => check.asArray([1, 2, 3], "x", 2), /at most 2 entries/);
});

test("errors name the place and never repeat a text", () => {
  fails(
    () => check.asList([1, 2, "secret"], "photos[3].w", (v, p) => check.asNumber(v, p)),
    /^photos\[3\]\.w\[2\]: .*found text$/,
  );
  fails(() => check.asChoice("secret", "x", ["a", "b"]), /one of a, b expected, found text/);
  assert.equal(check.asChoice("b", "x", ["a", "b"]), "b");
  fails(() => check.parseJson("{", "project.json"), /^project\.json: it is not valid JSON/);
});

test("vectors and rotations have the right length", () => {
  assert.deepEqual(check.asVec2([1, 2], "x"), [1, 2]);
  assert.deepEqual(check.asVec3([1, 2, 3], "x"), [1, 2, 3]);
  fails(() => check.asVec3([1, 2], "x"), /3 numbers expected/);
  fails(() => check.asVec3([1, 2, Number.NaN], "x"), /x\[2\]/);
  fails(() => check.asQuat([0, 0, 0, 0], "q"), /length 1/);
  fails(() => check.asQuat([2, 0, 0, 0], "q"), /length 1/);
  assert.deepEqual(check.asQuat([1.001, 0, 0, 0], "q"), [1, 0, 0, 0]);
});

test("what may be missing is null, what is wrong is still wrong", () => {
  assert.equal(check.optionalNumber(undefined, "x"), null);
  assert.equal(check.optionalNumber(null, "x"), null);
  assert.equal(check.optionalNumber(0, "x"), 0);
  assert.equal(check.optionalString("", "x"), "");
  fails(() => check.optionalNumber("1", "x"), /a number expected/);
  fails(() => check.asString("abc", "x", 2), /at most 2 characters/);
});
