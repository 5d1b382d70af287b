// All around the view on a page that only plays a tour.
import { type ReactElement, useEffect } from "react";
import type { PlayContext } from "../context.js";
import { PlayProvider } from "../use_store.js";
import { ExposureFilter } from "./exposure_filter.js";
import { TourPlayer } from "./tour_player.js";

export function TourPage({ context }: { readonly context: PlayContext }): ReactElement {
  const { project, scene, store } = context;
  const { title } = store.get().documents.tour;
  const name = title === "" ? project.name : title;
  const { canvas } = scene;
  useEffect(() => {
    canvas.setAttribute(
      "aria-label",
      `3-D view of ${name}. Dragging looks around, arrow keys go to the next stop and back.`,
    );
    document.title = name;
  }, [canvas, name]);
  return (
    <PlayProvider value={context}>
      <ExposureFilter />
      <TourPlayer />
    </PlayProvider>
  );
}
