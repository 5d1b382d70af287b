// Compass: shows where north is; a click turns north up.
import type { ReactElement } from "react";
import { useApp, useStore } from "../use_store.js";
import { keysOf } from "../widgets/command_keys.js";
import { turnNorthUp } from "./turn_north.js";

export function Compass(): ReactElement {
  const context = useApp();
  const headingDeg = useStore((state) => Math.round(state.readout.headingDeg * 10) / 10);
  const keys = keysOf(context.commands, "view.north");
  const heading = Number.isFinite(headingDeg) ? headingDeg : 0;
  return (
    <button
      type="button"
      className="compass"
      aria-label={`Compass: heading ${Math.round(heading)} degrees. Turn north up`}
      onClick={() => void turnNorthUp(context)}
    >
      <svg viewBox="-24 -24 48 48" width="44" height="44" aria-hidden="true">
        <g transform={`rotate(${-heading})`}>
          <circle className="compass-ring" r="20" />
          <path className="compass-north" d="M0 -15L4.6 0H-4.6z" />
          <path className="compass-south" d="M0 15L4.6 0H-4.6z" />
          <text className="compass-letter" y="-16.5">
            N
          </text>
        </g>
      </svg>
      <span className="tip tip-left" aria-hidden="true">
        North up
        {keys.slice(0, 1).map((key) => (
          <kbd key={key}>{key}</kbd>
        ))}
      </span>
    </button>
  );
}
