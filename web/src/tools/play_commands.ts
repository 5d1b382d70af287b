// Commands of a tour that is played. A page that only plays has these alone.
import type { AppState } from "../state/app_state.js";
import type { CommandTable } from "../state/commands.js";
import type { Store } from "../state/store.js";
import type { TourPlayback } from "./tour_playback.js";

interface PlayCommandsContext {
  readonly store: Store;
  readonly commands: CommandTable;
}

export const playing = (state: AppState): boolean => !state.help && state.compare === null && state.play !== null;

/** Returns the function that takes them out again. */
export function addPlayCommands({ store, commands }: PlayCommandsContext, playback: TourPlayback): () => void {
  const ends: (() => void)[] = [];
  const add = commandAdder(commands, ends);
  add("play.next", "Next stop", ["ArrowRight", "PageDown"], playing, () => playback.next());
  add("play.previous", "Previous stop", ["ArrowLeft", "PageUp"], playing, () => playback.previous());
  add("play.auto", "Go on by itself, or stop that", ["Space"], playing, () =>
    store.get().play?.can.pause === true ? playback.pause() : playback.resume(),
  );
  add("play.back", "Back to the view of the stop", ["r"], playing, () => playback.back());
  return () => {
    for (const end of ends) end();
  };
}

export function commandAdder(commands: CommandTable, ends: (() => void)[]) {
  return (
    id: string,
    label: string,
    keys: readonly string[],
    when: (state: AppState) => boolean,
    run: () => void | Promise<void>,
  ): void => {
    ends.push(commands.add({ id, label, keys, when, run }));
  };
}
