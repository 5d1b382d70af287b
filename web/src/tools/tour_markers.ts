// What a marker in the scene does when it is chosen: in a tour that is played it leads on, in the editor it is opened, else one flies to its stop.
import type { SceneApi } from "../scene/scene_api.js";
import type { Store } from "../state/store.js";
import { setTourView } from "../state/tour_changes.js";
import { thingOf } from "../tour/edit_things.js";
import { poseOf } from "../tour/route.js";
import { stopOf } from "../tour/types.js";
import type { TourPlayback } from "./tour_playback.js";

/** Returns the function that ends it. */
export function listenToMarkers(
  store: Store,
  scene: Pick<SceneApi, "onThingChosen" | "flyTo">,
  playback: Pick<TourPlayback, "goTo">,
): () => void {
  return scene.onThingChosen((id) => {
    const { documents, play, tour, tool } = store.get();
    const thing = thingOf(documents.tour, id);
    if (thing === null) return;
    const target = thing.kind === "marker" ? stopOf(documents.tour, thing.to) : null;
    if (play !== null) {
      if (target !== null) playback.goTo(target.id);
    } else if (tour.locked === null) {
      if (tool === "thing") return;
      setTourView(store, { thing: id, stop: null });
      store.set({ panel: "tour" });
    } else if (target !== null) {
      void scene.flyTo(poseOf(target.pose));
    }
  });
}
