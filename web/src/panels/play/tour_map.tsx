// A small map: the stops, where one stands and where one looks, over the picture of the ground where there is one.
import type { ReactElement } from "react";
import { usePlay, useStore } from "../use_store.js";
import { onMap, pictureTransform, tourBox, withinMap } from "./tour_map_view.js";

const percent = (share: number) => `${(100 * share).toFixed(2)}%`;

export function TourMap(): ReactElement | null {
  const { controls, scene } = usePlay();
  const tour = useStore(({ documents }) => documents.tour);
  const at = useStore((state) => state.play?.stop?.id);
  const ground = useStore((state) => state.map);
  const heading = useStore((state) => state.readout.headingDeg);
  // It is told together with the heading, and the map follows as often.
  useStore((state) => state.readout);
  const box = tourBox(
    tour.stops.map(({ pose }) => pose.eyeEnu),
    ground,
  );
  if (box === null) return null;
  const [x, y] = withinMap(onMap(box, scene.pose().eyeEnu));
  return (
    <section className="player-map card" aria-label="Map of the stops">
      <svg
        className="player-ground"
        viewBox={`${box.left} ${box.top} ${box.sideM} ${box.sideM}`}
        aria-hidden="true"
        focusable="false"
      >
        {ground === null ? null : (
          <image
            href={ground.url}
            width={1}
            height={1}
            preserveAspectRatio="none"
            transform={pictureTransform(ground)}
          />
        )}
      </svg>
      <svg
        className="player-eye"
        viewBox="-12 -12 24 24"
        style={{ left: percent(x), top: percent(y) }}
        aria-hidden="true"
      >
        <g transform={`rotate(${heading.toFixed(1)})`}>
          <path className="player-sight" d="M0 0L-7 -11H7Z" />
          <circle className="player-self" r={4} />
        </g>
      </svg>
      {tour.stops.map(({ id, title, pose }, i) => {
        const [left, top] = onMap(box, pose.eyeEnu);
        return (
          <button
            key={id}
            type="button"
            className="player-dot"
            style={{ left: percent(left), top: percent(top) }}
            aria-label={`Stop ${i + 1}: ${title}`}
            aria-current={id === at ? "step" : undefined}
            title={title}
            onClick={() => controls.goTo(id)}
          >
            {i + 1}
          </button>
        );
      })}
    </section>
  );
}
