// Commands: what buttons, keys and the help share. Each is one record; the keyboard finds it by its key, the help prints the table.
import type { AppState } from "./app_state.js";

export interface Command {
  /** "group.name", for instance "tool.distance". */
  readonly id: string;
  readonly label: string;
  /** As they are shown: "Ctrl+Shift+Z", "?", "Home", "k". Letters without Shift are those of the plain key. */
  readonly keys: readonly string[];
  when(state: AppState): boolean;
  run(): void | Promise<void>;
}

/** What counts of a keyboard event; Command on a Mac is given as ctrl. */
export interface KeyPress {
  readonly key: string;
  readonly ctrl: boolean;
  readonly shift: boolean;
  readonly alt: boolean;
}

const MODIFIERS = ["ctrl", "shift", "alt"] as const;

/** One spelling per key. Shift counts for letters and named keys only: where "?" and digits are differs between keyboards. */
export function canonicalKey({ key, ctrl, shift, alt }: KeyPress): string {
  // A space could not be seen in the help.
  const plain = key === " " ? "Space" : key.length === 1 ? key.toLowerCase() : key;
  const shifted = shift && (key.length !== 1 || plain !== key.toUpperCase());
  return `${ctrl ? "ctrl+" : ""}${shifted ? "shift+" : ""}${alt ? "alt+" : ""}${plain}`;
}

/** Of the text in a command: "Ctrl+Shift+Z". Throws when it has an unknown modifier or no key. */
export function canonicalKeyOfText(text: string): string {
  // A plus sign may be the key itself.
  const parts = text === "+" ? ["+"] : text.endsWith("++") ? [...text.slice(0, -2).split("+"), "+"] : text.split("+");
  const key = parts[parts.length - 1] ?? "";
  const modifiers = parts.slice(0, -1).map((part) => part.toLowerCase());
  const wrong = modifiers.find((part) => !MODIFIERS.some((known) => known === part));
  if (key === "" || wrong !== undefined) throw new Error(`"${text}" is not a key`);
  return canonicalKey({
    key,
    ctrl: modifiers.includes("ctrl"),
    shift: modifiers.includes("shift"),
    alt: modifiers.includes("alt"),
  });
}

export interface CommandHost {
  readonly state: () => AppState;
  /** A command failed. */
  readonly onError: (command: Command, error: unknown) => void;
}

export class CommandTable {
  private readonly commands = new Map<string, Command>();
  private readonly byKey = new Map<string, Command[]>();
  private host: CommandHost | null = null;

  /** Until this is called every command may run, and errors are thrown. */
  attach(host: CommandHost): void {
    this.host = host;
  }

  /** Returns the function that takes it out again. */
  add(command: Command): () => void {
    if (this.commands.has(command.id)) throw new Error(`there are two commands "${command.id}"`);
    const keys = new Set(command.keys.map(canonicalKeyOfText));
    this.commands.set(command.id, command);
    for (const key of keys) this.byKey.set(key, [...(this.byKey.get(key) ?? []), command]);
    return () => {
      if (this.commands.get(command.id) !== command) return;
      this.commands.delete(command.id);
      for (const key of keys) {
        const left = (this.byKey.get(key) ?? []).filter((other) => other !== command);
        if (left.length === 0) this.byKey.delete(key);
        else this.byKey.set(key, left);
      }
    };
  }

  get(id: string): Command | null {
    return this.commands.get(id) ?? null;
  }

  all(): readonly Command[] {
    return [...this.commands.values()];
  }

  /** Keys with more than one command; a test holds this empty. */
  conflicts(): readonly string[] {
    return [...this.byKey].filter(([, list]) => list.length > 1).map(([key]) => key);
  }

  enabled(id: string): boolean {
    const command = this.get(id);
    return command !== null && this.allowed(command);
  }

  /** Runs it when it may. An unknown id is an error of the program. */
  async run(id: string): Promise<void> {
    const command = this.get(id);
    if (command === null) throw new Error(`there is no command "${id}"`);
    if (this.allowed(command)) await this.start(command);
  }

  /** Runs the command of this key. False: there is none, or it may not run now, and the key is somebody else's. */
  handleKey(press: KeyPress): boolean {
    const command = this.byKey.get(canonicalKey(press))?.find((candidate) => this.allowed(candidate));
    if (command === undefined) return false;
    void this.start(command);
    return true;
  }

  private allowed(command: Command): boolean {
    return this.host === null || command.when(this.host.state());
  }

  private async start(command: Command): Promise<void> {
    try {
      await command.run();
    } catch (error) {
      if (this.host === null) throw error;
      this.host.onError(command, error);
    }
  }
}
