// Tells the scene which things of the tour to show: all while it is made, those of the stop while it is played.
import { Disposer } from "../base/disposer.js";
import type { SceneApi } from "../scene/scene_api.js";
import type { SceneThing } from "../scene/thing.js";
import type { AppState } from "../state/app_state.js";
import type { Store } from "../state/store.js";
import type { Thing } from "../tour/types.js";

type ThingScene = Pick<SceneApi, "setThings" | "highlightThings" | "invalidate">;

/** Returns the function that ends it. */
export function showTourThings(store: Store, scene: ThingScene, urlOf: (asset: string) => string): () => void {
  // The scene keeps what is the same object.
  const made = new WeakMap<Thing, SceneThing>();
  const sceneThing = (thing: Thing): SceneThing => {
    const known = made.get(thing);
    if (known !== undefined) return known;
    const next = asSceneThing(thing, urlOf);
    made.set(thing, next);
    return next;
  };
  const disposer = new Disposer();
  let last: readonly Thing[] = [];
  const show = () => {
    const things = thingsToShow(store.get());
    if (things.length === last.length && things.every((thing, i) => thing === last[i])) return;
    last = things;
    scene.setThings(things.map(sceneThing));
    scene.invalidate();
  };
  show();
  for (const part of [
    (state: AppState) => state.documents.tour,
    (state: AppState) => state.layers.things,
    (state: AppState) => state.play?.things ?? null,
  ]) {
    disposer.add(store.subscribe<unknown>(part, show));
  }
  disposer.add(
    store.subscribe(
      ({ tour, play, panel }) => (play === null && panel === "tour" ? tour.thing : null),
      (selected) => scene.highlightThings(selected, null),
    ),
  );
  return () => disposer.dispose();
}

export function thingsToShow({ documents, layers, play }: AppState): readonly Thing[] {
  if (play !== null) return play.things;
  return layers.things ? documents.tour.things : [];
}

function asSceneThing(thing: Thing, urlOf: (asset: string) => string): SceneThing {
  const { id, kind, at } = thing;
  if (kind !== "model") return { id, kind, at, text: thing.text };
  const { yawDeg, scale, name, asset } = thing;
  return { id, kind, at, yawDeg, scale, name, url: urlOf(asset) };
}
