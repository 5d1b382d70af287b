// Size of the exact frame for a canvas: its device pixels, but no more than the engine renders in a few seconds.
import type { Vec2 } from "../base/vec.js";

const MOST_PIXELS = 1000 * 563;
const LONGEST_SIDE_PX = 1600;
const SHORTEST_SIDE_PX = 16;

export function exactSize(widthPx: number, heightPx: number): Vec2 {
  const w = Math.max(1, Number.isFinite(widthPx) ? widthPx : 1);
  const h = Math.max(1, Number.isFinite(heightPx) ? heightPx : 1);
  const factor = Math.min(1, Math.sqrt(MOST_PIXELS / (w * h)), LONGEST_SIDE_PX / Math.max(w, h));
  const side = (px: number) => Math.min(LONGEST_SIDE_PX, Math.max(SHORTEST_SIDE_PX, Math.round(px * factor)));
  return [side(w), side(h)];
}
