// The tour as visitors see it: title and text of the stop, ways on, list of stops, map. Needs only the store and the context for playing, so that a page
// without editor shows it too.
import { type PointerEvent, type ReactElement, useRef, useState } from "react";
import type { Vec2 } from "../../base/vec.js";
import type { Stop } from "../../tour/types.js";
import { usePlay, useStore } from "../use_store.js";
import { Notices } from "../widgets/notices.js";
import { swipeOf } from "./swipe_gesture.js";
import { TourCard } from "./tour_card.js";
import { TourMap } from "./tour_map.js";
import { TourPlayBar } from "./tour_play_bar.js";
import { TourPlayList } from "./tour_play_list.js";

export function TourPlayer(): ReactElement | null {
  const play = useStore((state) => state.play);
  const tour = useStore(({ documents }) => documents.tour);
  const [list, setList] = useState(false);
  const [map, setMap] = useState(() => window.innerWidth > 720);
  const swipe = useSwipe();
  const stop = play?.stop ?? null;
  if (play === null || stop === null) return null;
  return (
    <div className="player">
      <h1 className="sr-only">{tour.title === "" ? "Tour" : tour.title}</h1>
      <Announcement stop={stop} arrived={play.arrived} />
      <div className="player-messages messages">
        <Notices />
      </div>
      {map ? <TourMap /> : null}
      <div className="player-side" {...swipe}>
        {list ? <TourPlayList onChosen={() => setList(false)} /> : null}
        <TourCard key={stop.id} stop={stop} arrived={play.arrived} />
        <TourPlayBar
          list={list}
          map={map}
          onList={() => setList((open) => !open)}
          onMap={() => setMap((open) => !open)}
        />
      </div>
    </div>
  );
}

/** For those who do not see the view: read out when the stop is reached. */
function Announcement({ stop, arrived }: { readonly stop: Stop; readonly arrived: boolean }): ReactElement {
  const tour = useStore(({ documents }) => documents.tour);
  const place = tour.stops.findIndex(({ id }) => id === stop.id) + 1;
  return (
    <p className="sr-only" aria-live="polite">
      {arrived ? `Stop ${place} of ${tour.stops.length}: ${stop.title}` : `On the way to ${stop.title}`}
    </p>
  );
}

/** Fingers on the card and the bar; on the view they look around. */
function useSwipe() {
  const { controls } = usePlay();
  const start = useRef<{ readonly id: number; readonly px: Vec2; readonly atMs: number } | null>(null);
  return {
    onPointerDown: (event: PointerEvent) => {
      if (event.pointerType !== "touch") return;
      start.current = { id: event.pointerId, px: [event.clientX, event.clientY], atMs: event.timeStamp };
    },
    onPointerUp: (event: PointerEvent) => {
      const from = start.current;
      start.current = null;
      if (from === null || from.id !== event.pointerId) return;
      const way = swipeOf(from.px, [event.clientX, event.clientY], event.timeStamp - from.atMs);
      if (way === "left") controls.next();
      else if (way === "right") controls.previous();
    },
    onPointerCancel: () => {
      start.current = null;
    },
  };
}
