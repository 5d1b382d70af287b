import assert from "node:assert/strict";
import test from "node:test";
import { boxWith, cornersOfBefore } from "../../../src/scene/boxes.js";
import { sampleBase, sampleProject } from "./samples.js";

test("the box of what is seen holds the earlier project where it lies", () => {
  const turned = [0, -1, 0, 100, 1, 0, 0, 0, 0, 0, 1, -7, 0, 0, 0, 1];
  const before = { ...sampleBase({ min: [0, 0, 0], max: [10, 20, 5] }), enuFromBefore: turned };
  const corners = cornersOfBefore(sampleProject({ before }));
  assert.deepEqual(boxWith({ min: [90, 1, 0], max: [91, 2, 40] }, corners), { min: [80, 0, -7], max: [100, 10, 40] });
  assert.deepEqual(cornersOfBefore(sampleProject()), []);
  const box = { min: [0, 0, 0], max: [1, 1, 1] } as const;
  assert.deepEqual(boxWith(box, [[Number.NaN, 9, 9]]), box);
});
