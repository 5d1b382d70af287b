// Which labels and markers are hidden.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Vec2 } from "../../../src/base/vec.js";
import { norm, sub } from "../../../src/base/vec_math.js";
import { depthInFrame, type FrameDepth, pointOfFrame } from "../../../src/scene/frame_sight.js";
import { SightQueue } from "../../../src/scene/sight_queue.js";
import { cameraFromEnu, projectPoint } from "../../../src/scene/view_math.js";
import { lookingAt } from "./samples.js";

test("a few at a time, and everyone in the end", () => {
  const queue = new SightQueue();
  const hidden = new Set(["b"]);
  const asked: string[] = [];
  const isHidden = (id: string) => {
    asked.push(id);
    return hidden.has(id);
  };
  queue.renew(["a", "b", "c"]);
  assert.equal(queue.sees("a"), false);
  // Out of time at once: still one each time.
  for (let i = 0; i < 3; i += 1) {
    assert.equal(queue.busy, true);
    queue.step(isHidden, () => true);
  }
  assert.deepEqual(asked, ["a", "b", "c"]);
  assert.equal(queue.busy, false);
  assert.deepEqual(
    ["a", "b", "c"].map((id) => queue.sees(id)),
    [true, false, true],
  );
});

test("until it is found anew the old finding counts; what is gone is forgotten", () => {
  const queue = new SightQueue();
  let hidden = false;
  const look = () =>
    queue.step(
      () => hidden,
      () => false,
    );
  queue.renew(["a", "b"]);
  look();
  hidden = true;
  queue.renew(["b"]);
  assert.deepEqual([queue.sees("a"), queue.sees("b")], [false, true]);
  look();
  assert.equal(queue.sees("b"), false);
});

function frame(orthoHeightM: number | null): FrameDepth {
  const pose = lookingAt([100, -50, 80], [20, 30, 5], orthoHeightM);
  const [width, height] = [8, 6];
  return {
    ...pose,
    fovyDeg: orthoHeightM === null ? pose.fovyDeg : null,
    width,
    height,
    depthWidth: 4,
    depthHeight: 3,
    depthM: Float32Array.from({ length: 12 }, (_, i) => (i === 5 ? Number.NaN : 10 + i)),
  };
}

test("a depth sample belongs to the four pixels that it was made for", () => {
  const one = frame(null);
  const at = (x: number, y: number) => depthInFrame(one, [(x + 0.5) / 8, (y + 0.5) / 6]);
  assert.deepEqual([at(0, 0), at(1, 1), at(2, 0), at(0, 2), at(7, 5)], [10, 10, 11, 14, 21]);
  // No surface: nothing hides.
  assert.equal(at(2, 2), Number.POSITIVE_INFINITY);
  assert.deepEqual([depthInFrame(one, [-1, -1]), depthInFrame(one, [2, 2])], [10, 21]);
});

test("a place of a frame is where the camera sees it", () => {
  for (const ortho of [null, 40]) {
    const one = frame(ortho);
    const pose = lookingAt([100, -50, 80], [20, 30, 5], ortho);
    const place: Vec2 = [0.2, 0.85];
    const point = pointOfFrame(one, place, 33);
    assert.ok(Math.abs(cameraFromEnu(pose, point)[2] - 33) < 1e-9);
    const px = projectPoint(pose, [800, 600], point) ?? [0, 0];
    assert.ok(Math.hypot(px[0] - 160, px[1] - 510) < 1e-6, `${px}`);
    assert.ok(norm(sub(point, one.eyeEnu)) >= 33 - 1e-9);
  }
});
