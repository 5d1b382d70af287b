// Commands of the tour: making it, beginning to play it and leaving it, and what to do when another window has saved it.
import type { AppState } from "../state/app_state.js";
import { freeName } from "../state/names.js";
import { addNotice } from "../state/notices.js";
import { changeTour, setTourView } from "../state/tour_changes.js";
import { tourPose } from "../state/tour_pose.js";
import { addStop, newStop } from "../tour/edit_stops.js";
import { commandAdder, playing } from "./play_commands.js";
import type { ToolContext } from "./tool_context.js";
import type { TourConflict } from "./tour_conflict.js";
import type { TourPlayback } from "./tour_playback.js";

const free = (state: AppState): boolean => !state.help && state.compare === null && state.play === null;

/** Returns the function that takes them out again. */
export function addTourCommands(context: ToolContext, playback: TourPlayback, conflict: TourConflict): () => void {
  const ends: (() => void)[] = [];
  const add = commandAdder(context.commands, ends);
  const editing = (state: AppState) => free(state) && state.tour.locked === null;
  add("tour.addStop", "Add the view to the tour as a stop", ["Shift+K"], editing, () => addViewAsStop(context));
  add(
    "tour.play",
    "Play the tour",
    ["Shift+U"],
    (state) => free(state) && state.documents.tour.stops.length > 0,
    () => playback.play(),
  );
  const undecided = (state: AppState) => free(state) && state.tour.conflict;
  add("tour.takeOther", "Take the tour of the other window", [], undecided, () => conflict.takeOther());
  add("tour.keepMine", "Keep the tour of this window", [], undecided, () => conflict.keepMine());
  add("play.leave", "Leave the tour (Esc)", [], playing, () => playback.leave());
  return () => {
    for (const end of ends) end();
  };
}

function addViewAsStop({ store, scene }: Pick<ToolContext, "store" | "scene">): void {
  let id: string | null = null;
  const done = changeTour(store, "add stop", (tour) => {
    const title = freeName(
      "Stop",
      tour.stops.map((stop) => stop.title),
    );
    const stop = newStop(tour, title, tourPose(scene));
    id = stop.id;
    return addStop(tour, stop);
  });
  if (!done) return;
  // In its panel it is seen, and opened.
  if (store.get().panel === "tour") setTourView(store, { stop: id, thing: null });
  else addNotice(store, "info", `Stop ${store.get().documents.tour.stops.length} was added to the tour.`);
}
