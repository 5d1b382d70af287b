// Compass, kind of navigation and "all in view" at the upper right of the 3-D view.
import type { ReactElement } from "react";
import type { Navigation } from "../../state/app_state.js";
import { useApp, useStore } from "../use_store.js";
import { keysOf } from "../widgets/command_keys.js";
import { IconButton } from "../widgets/icon_button.js";
import { Compass } from "./compass.js";

const WAYS: readonly { readonly name: Navigation; readonly label: string; readonly hint: string }[] = [
  { name: "map", label: "Map", hint: "Drag the ground, turn about it" },
  { name: "fly", label: "Fly", hint: "Look around, W A S D moves" },
  { name: "top", label: "Top", hint: "From straight above, to scale" },
];

export function ViewControls(): ReactElement {
  const { store, scene, project, commands } = useApp();
  const navigation = useStore((state) => state.navigation);
  return (
    <div className="view-controls">
      <Compass />
      <fieldset className="segments card">
        <legend className="sr-only">Navigation</legend>
        {WAYS.map(({ name, label, hint }) => (
          <button
            type="button"
            key={name}
            className="segment"
            aria-pressed={navigation === name}
            title={[hint, ...keysOf(commands, `navigation.${name}`).slice(0, 1)].join(" – ")}
            onClick={() => store.set({ navigation: name })}
          >
            {label}
          </button>
        ))}
      </fieldset>
      <div className="card">
        <IconButton
          icon="home"
          label="All in view"
          side="left"
          keys={keysOf(commands, "view.all")}
          onClick={() => void scene.frameBox(project.min, project.max)}
        />
      </div>
    </div>
  );
}
