// Groups of commands for the help, by the first part of their ids.
import type { Command } from "../../state/commands.js";

export interface CommandGroup {
  readonly title: string;
  readonly commands: readonly Command[];
}

const TITLES: readonly (readonly [prefix: string, title: string])[] = [
  ["view", "View"],
  ["navigation", "View"],
  ["tool", "Tools"],
  ["edit", "Editing"],
  ["measure", "Editing"],
  ["draft", "Editing"],
  ["panel", "Panels"],
  ["layer", "Layers"],
  ["path", "Camera path"],
  ["tour", "Tour"],
  ["play", "Playing the tour"],
];
const OTHERS = "More";

export function groupCommands(commands: readonly Command[]): readonly CommandGroup[] {
  const titles = new Map(TITLES);
  const groups = new Map<string, Command[]>();
  for (const title of [...new Set(titles.values()), OTHERS]) groups.set(title, []);
  for (const command of commands) {
    const prefix = command.id.split(".")[0] ?? "";
    groups.get(titles.get(prefix) ?? OTHERS)?.push(command);
  }
  return [...groups].filter(([, group]) => group.length > 0).map(([title, group]) => ({ title, commands: group }));
}
