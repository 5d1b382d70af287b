// The colours of the held-out error and what they mean.
import type { ReactElement } from "react";
import { useStore } from "../use_store.js";
import { rampGradient } from "../widgets/ramp.js";

export function ErrorLegend(): ReactElement | null {
  const errorMap = useStore((state) => state.errorMap);
  if (errorMap === null) return null;
  const last = errorMap.scale * 255;
  return (
    <figure className="legend">
      <div className="legend-ramp" style={{ backgroundImage: rampGradient() }} />
      <div className="legend-scale">
        <span>0</span>
        <span>{(last / 2).toFixed(1)}</span>
        <span>{last.toFixed(1)} or more</span>
      </div>
      <figcaption className="hint">
        Mean difference of colours (of 255) between held-out photos and the field; {errorMap.photos} of{" "}
        {errorMap.ofPhotos} photos used.
      </figcaption>
    </figure>
  );
}
