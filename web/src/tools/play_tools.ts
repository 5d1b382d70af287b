// What plays a tour: playback, its keys, what markers do, and the things of the stops. Needs no editor, so that the page of an exported tour has it too.
import type { Clock } from "../base/clock.js";
import { Disposer } from "../base/disposer.js";
import type { SceneApi } from "../scene/scene_api.js";
import type { CommandTable } from "../state/commands.js";
import type { Store } from "../state/store.js";
import { listenToCommandKeys } from "./keyboard.js";
import { addPlayCommands } from "./play_commands.js";
import { listenToMarkers } from "./tour_markers.js";
import { type Ground, TourPlayback } from "./tour_playback.js";
import { showTourThings } from "./tour_things.js";

export interface PlayToolsOptions {
  readonly store: Store;
  readonly scene: SceneApi;
  readonly commands: CommandTable;
  readonly clock: Clock;
  readonly page: Window;
  /** Where the file of a model is. */
  readonly urlOf: (asset: string) => string;
  readonly ground: () => Promise<Ground>;
}

export interface PlayTools {
  readonly playback: TourPlayback;
  dispose(): void;
}

export function createPlayTools({ store, scene, commands, clock, page, urlOf, ground }: PlayToolsOptions): PlayTools {
  const disposer = new Disposer();
  disposer.own(listenToCommandKeys(page, commands, () => store.get().play !== null));
  const playback = disposer.own(
    new TourPlayback({
      store,
      scene,
      clock,
      ground,
      nextFrame: (draw) => {
        const frame = page.requestAnimationFrame(draw);
        return () => page.cancelAnimationFrame(frame);
      },
      reducedMotion: () => page.matchMedia("(prefers-reduced-motion: reduce)").matches,
    }),
  );
  disposer.add(listenToMarkers(store, scene, playback));
  disposer.add(showTourThings(store, scene, urlOf));
  disposer.add(addPlayCommands({ store, commands }, playback));
  return { playback, dispose: () => disposer.dispose() };
}
