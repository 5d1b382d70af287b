// Size of the exact frame for a canvas: its device pixels, but no more than the engine renders in a few seconds, or than a link has ready.
import type { Vec2 } from "../base/vec.js";

const RENDERED_PX = { side: 1600, all: 1000 * 563 } as const;
const SHORTEST_SIDE_PX = 16;

export function exactSize(
  widthPx: number,
  heightPx: number,
  most: { readonly side: number; readonly all: number } = RENDERED_PX,
): Vec2 {
  const w = Math.max(1, Number.isFinite(widthPx) ? widthPx : 1);
  const h = Math.max(1, Number.isFinite(heightPx) ? heightPx : 1);
  const factor = Math.min(1, Math.sqrt(most.all / (w * h)), most.side / Math.max(w, h));
  const side = (px: number) => Math.min(most.side, Math.max(SHORTEST_SIDE_PX, Math.round(px * factor)));
  return [side(w), side(h)];
}
