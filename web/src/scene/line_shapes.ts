// Edges of boxes and frustums of cameras as pieces of lines, ENU minus an anchor.
import type { Vec3 } from "../base/vec.js";
import { add, quatConjugate, quatRotate, sub } from "../base/vec_math.js";
import type { Photo, PhotoCamera } from "../state/project.js";
import type { Box } from "./world.js";

/** Pairs of corners, numbered by 4 x + 2 y + z of 0 (min) or 1 (max). */
const EDGES = [0, 1, 2, 3, 4, 5, 6, 7, 0, 2, 1, 3, 4, 6, 5, 7, 0, 4, 1, 5, 2, 6, 3, 7] as const;

/** 12 edges, 24 points. */
export function boxEdges(box: Box, anchor: Vec3): number[] {
  const { min, max } = box;
  const corner = (i: number): Vec3 => [i & 4 ? max[0] : min[0], i & 2 ? max[1] : min[1], i & 1 ? max[2] : min[2]];
  return EDGES.flatMap((i) => sub(corner(i), anchor));
}

/** Half width and half height of a photo at distance 1, without distortion; COLMAP's parameters begin with the focal length or lengths. */
function photoHalfSize(camera: PhotoCamera): readonly [number, number] {
  const single = camera.model.startsWith("SIMPLE") || camera.model.startsWith("RADIAL");
  const fx = camera.params[0] ?? 0;
  const fy = (single ? camera.params[0] : camera.params[1]) ?? 0;
  const half = (pixels: number, focal: number) => (focal > 0 && pixels > 0 ? Math.min(2, pixels / (2 * focal)) : 0.5);
  return [half(camera.width, fx), half(camera.height, fy)];
}

/** A pyramid from the photo's place, `depthM` long, and a mark at its upper side: 22 points. */
export function frustumEdges(photo: Photo, camera: PhotoCamera, depthM: number, anchor: Vec3): number[] {
  const [w, h] = photoHalfSize(camera);
  const back = quatConjugate(photo.rotation);
  const at = (x: number, y: number): Vec3 =>
    add(photo.position, quatRotate(back, [x * w * depthM, y * h * depthM, depthM]));
  const corners = [at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)];
  const points: Vec3[] = [];
  for (const [i, corner] of corners.entries())
    points.push(photo.position, corner, corner, corners[(i + 1) % 4] ?? corner);
  const top = at(0, -1.35);
  points.push(at(-0.4, -1), top, top, at(0.4, -1));
  // NaN in one photo must not hide all the others.
  return points.every((point) => point.every(Number.isFinite)) ? points.flatMap((point) => sub(point, anchor)) : [];
}

/** Length of the pyramids: a part of the distance between neighbouring photos, so that they do not hide each other. */
export function frustumDepthM(photos: readonly Photo[], sizeM: number): number {
  const gaps: number[] = [];
  for (let i = 0; i + 1 < photos.length; i += 1) {
    const [a, b] = [photos[i]?.position, photos[i + 1]?.position];
    if (a !== undefined && b !== undefined) gaps.push(Math.hypot(...sub(a, b)));
  }
  gaps.sort((a, b) => a - b);
  const usual = gaps[Math.floor(gaps.length / 2)] ?? sizeM / 20;
  return Math.min(sizeM / 20, Math.max(sizeM / 400, 0.4 * usual));
}
