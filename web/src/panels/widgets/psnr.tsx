// A PSNR with its colour.
import type { ReactElement } from "react";
import { psnrQuality, rampColour } from "./ramp.js";

export function Psnr({ valueDb }: { readonly valueDb: number | null }): ReactElement {
  if (valueDb === null) return <span className="hint">unknown</span>;
  return (
    <span className="psnr">
      <span className="chip" style={{ backgroundColor: rampColour(psnrQuality(valueDb)) }} />
      {valueDb.toFixed(1)} dB
    </span>
  );
}
