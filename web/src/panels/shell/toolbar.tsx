// Tools at the left edge; undo and redo below them.

import type { ReactElement } from "react";
import type { ToolName } from "../../state/app_state.js";
import { useApp, useStore } from "../use_store.js";
import { keysOf } from "../widgets/command_keys.js";
import { IconButton } from "../widgets/icon_button.js";

const TOOLS: readonly { readonly name: ToolName; readonly label: string }[] = [
  { name: "navigate", label: "Navigate" },
  { name: "point", label: "Point: coordinates and height" },
  { name: "distance", label: "Distance" },
  { name: "profile", label: "Height profile" },
  { name: "area", label: "Area" },
  { name: "volume", label: "Volume" },
  { name: "photos", label: "Photos that see a point" },
  { name: "control", label: "Control point" },
  { name: "thing", label: "Label or marker of the tour" },
];

export function Toolbar(): ReactElement {
  const { store, commands } = useApp();
  const tool = useStore((state) => state.tool);
  const locked = useStore((state) => state.tour.locked !== null);
  // History is no part of the state, but changes only together with the documents.
  useStore((state) => state.documents);
  const { undoLabel, redoLabel } = store.history;
  // While something is drawn, undo takes its last point away.
  const drawing = useStore((state) => state.draft.length > 0);
  return (
    <div className="toolbar card" role="toolbar" aria-label="Tools" aria-orientation="vertical">
      {TOOLS.filter(({ name }) => name !== "thing" || !locked).map(({ name, label }) => (
        <IconButton
          key={name}
          icon={name}
          label={label}
          keys={keysOf(commands, `tool.${name}`)}
          pressed={tool === name}
          className={name === "navigate" || name === "photos" ? "group-end" : ""}
          onClick={() => void commands.run(`tool.${name}`)}
        />
      ))}
      <span className="toolbar-rule" />
      <IconButton
        icon="undo"
        label={undoLabel === null ? "Undo" : `Undo: ${undoLabel}`}
        keys={keysOf(commands, "edit.undo")}
        disabled={undoLabel === null && !drawing}
        onClick={() => void commands.run("edit.undo")}
      />
      <IconButton
        icon="redo"
        label={redoLabel === null ? "Redo" : `Redo: ${redoLabel}`}
        keys={keysOf(commands, "edit.redo")}
        disabled={redoLabel === null}
        onClick={() => void commands.run("edit.redo")}
      />
    </div>
  );
}
