// A finger that is drawn quickly to one side.
import type { Vec2 } from "../../base/vec.js";

const LEAST_PX = 40;
const LONGEST_MS = 800;

/** "left": to the next one; null: it was no swipe. */
export function swipeOf(from: Vec2, to: Vec2, durationMs: number): "left" | "right" | null {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  if (Math.abs(dx) < LEAST_PX || Math.abs(dx) < 2 * Math.abs(dy) || durationMs > LONGEST_MS) return null;
  return dx < 0 ? "left" : "right";
}
