// What the next click on the surface does, while something is being placed.
import type { ReactElement } from "react";
import type { Placing } from "../../state/tour_state.js";
import { useStore } from "../use_store.js";

export function TourPlacing(): ReactElement | null {
  const placing = useStore((state) => (state.tool === "thing" ? state.tour.placing : null));
  if (placing === null) return null;
  return (
    <p className="placing" role="status">
      {placingText(placing)} <kbd>.</kbd> takes the middle of the view, <kbd>Esc</kbd> ends it.
    </p>
  );
}

function placingText(placing: Placing): string {
  switch (placing.kind) {
    case "label":
      return "Click where the label points to.";
    case "marker":
      return "Click where the marker points to.";
    case "model":
      return `Click where ${placing.asset.name} is to stand.`;
    case "move":
      return "Click where it is to be.";
    case "centre":
      return "Click the point that the way leads around.";
    default:
      return placing satisfies never;
  }
}
