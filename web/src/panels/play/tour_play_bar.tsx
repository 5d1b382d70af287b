// Buttons of the player: back, on, by itself, list, map, full screen, leave; and how far one is.
import type { ReactElement } from "react";
import type { Phase } from "../../tour/player_view.js";
import { usePlay, useStore } from "../use_store.js";
import { keysOf } from "../widgets/command_keys.js";
import { IconButton } from "../widgets/icon_button.js";
import type { IconName } from "../widgets/icons.js";

const PROGRESS: Readonly<Record<Phase, string>> = {
  empty: "Nothing to show",
  stop: "Pause at the stop",
  moving: "Way to the stop",
  paused: "Way to the stop",
  look: "Looking around",
};

interface TourPlayBarProps {
  readonly list: boolean;
  readonly map: boolean;
  readonly onList: () => void;
  readonly onMap: () => void;
}

export function TourPlayBar({ list, map, onList, onMap }: TourPlayBarProps): ReactElement | null {
  const { commands } = usePlay();
  const play = useStore((state) => state.play);
  if (play === null) return null;
  const { can, progress, playing, phase } = play;
  const button = (id: string, icon: IconName, label: string, more: Partial<Parameters<typeof IconButton>[0]> = {}) => (
    <IconButton
      icon={icon}
      label={label}
      side="above"
      keys={keysOf(commands, id)}
      onClick={() => void commands.run(id)}
      {...more}
    />
  );
  return (
    <div className="player-bar card" role="toolbar" aria-label="Tour">
      {button("play.previous", "previous", "Previous stop", { disabled: !can.previous })}
      {can.pause
        ? button("play.auto", "pause", playing ? "Stop going on by itself" : "Halt", { pressed: playing })
        : button("play.auto", "play", "Go on by itself", { disabled: !can.play })}
      {button("play.next", "next", can.next ? "Next stop" : "The tour ends here", { disabled: !can.next })}
      <span className="player-place">
        {progress.index + 1} / {progress.count}
        <progress aria-label={PROGRESS[phase]} max={1} value={progress.share} />
      </span>
      {can.back ? button("play.back", "focus", "Back to the view of the stop") : null}
      <IconButton icon="list" label="All stops" side="above" pressed={list} onClick={onList} />
      <IconButton icon="map" label="Map" side="above" pressed={map} onClick={onMap} />
      {button("view.screen", "screen", "Full screen")}
      {commands.get("play.leave") === null ? null : button("play.leave", "close", "Leave the tour", { keys: ["Esc"] })}
    </div>
  );
}
