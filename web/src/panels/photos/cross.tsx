// A mark over a picture: a cross with an open middle, so that the place itself stays visible.
import type { ReactElement } from "react";
import type { Vec2 } from "../../base/vec.js";

const ARM_PX = 16;
const GAP_PX = 4;

interface CrossProps {
  /** View pixels. */
  readonly at: Vec2;
  readonly kind: "mark" | "predicted";
}

export function Cross({ at, kind }: CrossProps): ReactElement {
  const arms = `M${-ARM_PX} 0H${-GAP_PX}M${GAP_PX} 0H${ARM_PX}M0 ${-ARM_PX}V${-GAP_PX}M0 ${GAP_PX}V${ARM_PX}`;
  return (
    <svg
      className={`cross cross-${kind}`}
      width={2 * ARM_PX + 4}
      height={2 * ARM_PX + 4}
      viewBox={`${-ARM_PX - 2} ${-ARM_PX - 2} ${2 * ARM_PX + 4} ${2 * ARM_PX + 4}`}
      style={{ transform: `translate(${at[0] - ARM_PX - 2}px, ${at[1] - ARM_PX - 2}px)` }}
      aria-hidden="true"
    >
      <path className="cross-halo" d={arms} />
      <path className="cross-line" d={arms} />
      {kind === "predicted" ? <circle className="cross-line" r={9} fill="none" /> : null}
    </svg>
  );
}
