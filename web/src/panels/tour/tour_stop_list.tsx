// The stops in their order. A click flies there; the open one can be changed.
import type { ReactElement } from "react";
import { setTourView } from "../../state/tour_changes.js";
import type { Stop, Tour } from "../../tour/types.js";
import { useApp, useStore } from "../use_store.js";
import { isStart } from "./tour_names.js";
import { TourStopForm } from "./tour_stop_form.js";
import { goToStop } from "./tour_view.js";

export function TourStopList({ tour }: { readonly tour: Tour }): ReactElement | null {
  const context = useApp();
  const { store } = context;
  const opened = useStore((state) => state.tour.stop);
  const locked = useStore((state) => state.tour.locked !== null);
  if (tour.stops.length === 0) return null;
  const toggle = (stop: Stop): void => {
    const open = opened === stop.id;
    setTourView(store, { stop: open ? null : stop.id, thing: null });
    if (!open) goToStop(context, stop);
  };
  return (
    <ol className="points tour-stops">
      {tour.stops.map((stop, i) => {
        const open = opened === stop.id;
        return (
          <li key={stop.id} className={open ? "point-item selected" : "point-item"}>
            <button type="button" className="point-row" aria-expanded={open} onClick={() => toggle(stop)}>
              <span className="point-name">
                {i + 1}. {stop.title}
              </span>
              {isStart(tour, stop) && tour.start !== null ? <span className="badge">start</span> : null}
            </button>
            {open && !locked ? <TourStopForm tour={tour} stop={stop} place={i} /> : null}
          </li>
        );
      })}
    </ol>
  );
}
