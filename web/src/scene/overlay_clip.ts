// Lines and areas in the camera's frame, cut at the plane before the eye, so that what is behind the camera does not appear mirrored. Pure.
import type { Vec3 } from "../base/vec.js";

function crossing(a: Vec3, b: Vec3, near: number): Vec3 {
  const u = (near - a[2]) / (b[2] - a[2]);
  return [a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1]), near];
}

/** The parts of a line that are ahead. A closed line comes as its closed outline, cut as an area. */
export function clipLine(points: readonly Vec3[], closed: boolean, near: number): Vec3[][] {
  if (closed) {
    const area = clipArea(points, near);
    return area.length > 2 ? [area] : [];
  }
  const parts: Vec3[][] = [];
  let part: Vec3[] = [];
  for (const [i, point] of points.entries()) {
    const before = points[i - 1];
    const ahead = point[2] >= near;
    if (before !== undefined && before[2] >= near !== ahead) part.push(crossing(before, point, near));
    if (ahead) {
      part.push(point);
    } else if (part.length > 0) {
      parts.push(part);
      part = [];
    }
  }
  if (part.length > 0) parts.push(part);
  return parts.filter((piece) => piece.length > 1);
}

/** Sutherland and Hodgman 1974, for one plane. */
function clipArea(points: readonly Vec3[], near: number): Vec3[] {
  const kept: Vec3[] = [];
  for (const [i, point] of points.entries()) {
    const before = points[(i + points.length - 1) % points.length] ?? point;
    const ahead = point[2] >= near;
    if (before[2] >= near !== ahead) kept.push(crossing(before, point, near));
    if (ahead) kept.push(point);
  }
  return kept;
}
