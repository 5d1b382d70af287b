// The distance that a way keeps from what is solid. A piece of the way is judged by its middle: all of it lies within half its length of there. What
// cannot be told for a long piece is told for its halves, so nothing is missed between samples.
import type { Heights } from "./heights.js";
import { NOTHING } from "./heights.js";
import { type PlanLine, placeAt } from "./plan_line.js";

/** Kept from everything solid. */
export const CLEARANCE_M = 1;

/** A piece of the way in plan with the lowest z that is safe on all of it; NOTHING: every z is. */
export interface Barrier {
  readonly fromM: number;
  readonly toM: number;
  readonly z: number;
}

/** Longer pieces are halved unseen: their discs would hold too many cells. */
const LONGEST_PIECE_M = 1;
const MOST_PIECES_ACROSS = 4000;
const SHORTEST_PIECE_M = 0.02;
/** Barriers may be this much too high. */
const TOLERANCE_M = 0.25;
const SHORTEST_CHECK_M = 0.005;

function longestPiece(heights: Heights): number {
  const across = Math.hypot(heights.max[0] - heights.min[0], heights.max[1] - heights.min[1]);
  return Math.max(LONGEST_PIECE_M, across / MOST_PIECES_ACROSS);
}

/** Barriers along the whole line. Where they are below `baseZ`, the height of a way that needs no detour, they may be rough. */
export function barriersAlong(line: PlanLine, heights: Heights, baseZ: (lengthM: number) => number): Barrier[] {
  const barriers: Barrier[] = [];
  const longest = longestPiece(heights);
  const visit = (fromM: number, toM: number): void => {
    const half = (toM - fromM) / 2;
    const [x, y] = placeAt(line, fromM + half);
    if (heights.isFar(x, y, CLEARANCE_M + half)) {
      barriers.push({ fromM, toM, z: NOTHING });
      return;
    }
    if (toM - fromM <= longest) {
      const z = heights.dilated(x, y, CLEARANCE_M, half);
      const good =
        z <= Math.min(baseZ(fromM), baseZ(toM)) ||
        toM - fromM <= SHORTEST_PIECE_M ||
        z - heights.dilated(x, y, CLEARANCE_M) <= TOLERANCE_M;
      if (good) {
        barriers.push({ fromM, toM, z });
        return;
      }
    }
    visit(fromM, fromM + half);
    visit(fromM + half, toM);
  };
  if (line.lengthM > 0) visit(0, line.lengthM);
  return barriers;
}

/** Whether a piece of the way, straight in length and z, is nowhere nearer than the clearance. False also where this cannot be told. */
export function keepsClear(
  line: PlanLine,
  heights: Heights,
  [fromM, fromZ]: readonly [number, number],
  [toM, toZ]: readonly [number, number],
): boolean {
  const longest = longestPiece(heights);
  const check = (a: number, zA: number, b: number, zB: number): boolean => {
    const half = (b - a) / 2;
    const [x, y] = placeAt(line, a + half);
    if (heights.isFar(x, y, CLEARANCE_M + half)) return true;
    if (b - a <= longest) {
      if (heights.dilated(x, y, CLEARANCE_M, half) <= Math.min(zA, zB)) return true;
      if (b - a <= SHORTEST_CHECK_M || heights.dilated(x, y, CLEARANCE_M) > (zA + zB) / 2) return false;
    }
    const middle = (zA + zB) / 2;
    return check(a, zA, a + half, middle) && check(a + half, middle, b, zB);
  };
  return check(fromM, fromZ, toM, toZ);
}
