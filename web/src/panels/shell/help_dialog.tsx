// All commands with their keys, and what mouse, touch and keyboard do in the 3-D view.
import type { ReactElement } from "react";
import type { Command } from "../../state/commands.js";
import { useApp, useStore } from "../use_store.js";
import { IconButton } from "../widgets/icon_button.js";
import { ModalDialog } from "../widgets/modal_dialog.js";
import { groupCommands } from "./command_groups.js";

const HANDS: readonly (readonly [string, string])[] = [
  ["Left button, one finger", "move the ground; fly: look around"],
  ["Right button or Ctrl", "turn and tilt"],
  ["Two fingers", "move, turn, zoom"],
  ["Wheel", "zoom; fly: speed"],
  ["Arrow keys", "move; with Shift turn and tilt"],
  ["W A S D, Q E", "fly: ahead, aside, down, up"],
  ["Rest", "the exact frame of the field follows by itself"],
];

export function HelpDialog(): ReactElement | null {
  const { store, commands } = useApp();
  const help = useStore((state) => state.help);
  if (!help) return null;
  // As it will be when the command runs.
  const open = { ...store.get(), help: false };
  const close = (): void => store.set({ help: false });
  const run = (command: Command): void => {
    close();
    void commands.run(command.id);
  };
  return (
    <ModalDialog label="Keys and commands" className="help-dialog card" onClose={close}>
      <header className="panel-head">
        <h2 tabIndex={-1} data-first-focus="">
          Keys and commands
        </h2>
        <IconButton icon="close" label="Close" keys={["Esc"]} side="left" onClick={close} />
      </header>
      <div className="help-columns">
        <section className="help-section">
          <h3>In the 3-D view</h3>
          <dl className="facts hands">
            {HANDS.map(([hand, effect]) => (
              <div key={hand} className="fact">
                <dt>{hand}</dt>
                <dd>{effect}</dd>
              </div>
            ))}
          </dl>
        </section>
        {groupCommands(commands.all()).map(({ title, commands: group }) => (
          <section key={title} className="help-section">
            <h3>{title}</h3>
            <ul className="commands">
              {group.map((command) => (
                <li key={command.id} className="command-row">
                  <button type="button" className="link" disabled={!command.when(open)} onClick={() => run(command)}>
                    {command.label}
                  </button>
                  <span>
                    {command.keys.map((key) => (
                      <kbd key={key}>{key}</kbd>
                    ))}
                  </span>
                </li>
              ))}
            </ul>
          </section>
        ))}
      </div>
    </ModalDialog>
  );
}
