// The keys of a command for tooltips.
import type { CommandTable } from "../../state/commands.js";

export function keysOf(commands: CommandTable, id: string): readonly string[] {
  return commands.get(id)?.keys ?? [];
}
