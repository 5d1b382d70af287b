// Brightness of the view in stops: the light of what is shown, not its display values, is multiplied, by a filter of the browser over the canvas.
import { type ReactElement, useEffect } from "react";
import { usePlay, useStore } from "../use_store.js";

const ID = "view-exposure";

export function ExposureFilter(): ReactElement | null {
  const { scene } = usePlay();
  const stops = useStore((state) => state.exposureStops);
  useEffect(() => {
    scene.canvas.style.filter = stops === 0 ? "" : `url(#${ID})`;
    return () => {
      scene.canvas.style.filter = "";
    };
  }, [scene, stops]);
  if (stops === 0) return null;
  const slope = 2 ** stops;
  return (
    <svg className="sr-only" width={0} height={0} aria-hidden="true">
      <filter id={ID} colorInterpolationFilters="linearRGB" x={0} y={0} width={1} height={1}>
        <feComponentTransfer>
          <feFuncR type="linear" slope={slope} />
          <feFuncG type="linear" slope={slope} />
          <feFuncB type="linear" slope={slope} />
        </feComponentTransfer>
      </filter>
    </svg>
  );
}
