// The colours of a map of errors and what they mean.
import type { ReactElement } from "react";
import type { AppState } from "../../state/app_state.js";
import type { MapLayer } from "../../state/layers.js";
import { useStore } from "../use_store.js";
import { rampGradient } from "../widgets/ramp.js";

export function MapLegend({ name }: { readonly name: MapLayer }): ReactElement | null {
  const map = useStore((state) => state[name]);
  const caption = useStore((state) => captionOf(name, state));
  if (map === null) return null;
  const last = map.scale * 255;
  return (
    <figure className="legend">
      <div className="legend-ramp" style={{ backgroundImage: rampGradient() }} />
      <div className="legend-scale">
        <span>0</span>
        <span>{(last / 2).toFixed(1)}</span>
        <span>{last.toFixed(1)} or more</span>
      </div>
      <figcaption className="hint">{caption}</figcaption>
    </figure>
  );
}

function captionOf(name: MapLayer, { errorMap }: AppState): string {
  if (name === "trust")
    return "Difference of colours (of 255) to expect, from how well training photos agree with the field.";
  const used = errorMap === null ? "" : `; ${errorMap.photos} of ${errorMap.ofPhotos} photos used`;
  return `Mean difference of colours (of 255) between held-out photos and the field${used}.`;
}
