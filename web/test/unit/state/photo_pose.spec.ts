import assert from "node:assert/strict";
import test from "node:test";
import { photoFovyDeg } from "../../../src/state/photo_pose.js";

test("field of view of a photo by its camera model", () => {
  const camera = (model: string, params: number[]) => ({ model, width: 400, height: 200, params });
  const right = (deg: number, expected: number) => assert.ok(Math.abs(deg - expected) < 1e-9, `${deg}`);
  right(photoFovyDeg(camera("SIMPLE_RADIAL", [100, 200, 100, 0])), 90);
  right(photoFovyDeg(camera("OPENCV", [500, 100, 200, 100, 0, 0, 0, 0])), 90);
  right(photoFovyDeg(camera("OPENCV_FISHEYE", [500, 200, 200, 100, 0, 0, 0, 0])), 180 / Math.PI);
  right(photoFovyDeg(camera("RADIAL_FISHEYE", [200, 200, 100, 0, 0])), 180 / Math.PI);
  // atan(2 r tan(omega / 2)) / omega is half the height over the focal length where r = 1.
  const edge = Math.atan(2 * Math.tan(0.45)) / 0.9;
  right(photoFovyDeg(camera("FOV", [500, 100 / edge, 200, 100, 0.9])), 90);
  right(photoFovyDeg(camera("FOV", [500, 100, 200, 100, 0])), 90);
  assert.ok(photoFovyDeg(camera("PINHOLE", [])) > 0);
});
