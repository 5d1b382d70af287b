// A tool turns the pointer's events on the canvas into changes of the store. One is active at a time; navigation goes on while it is, except for events
// that the tool takes (returns true).
import type { Vec2 } from "../base/vec.js";
import type { ToolName } from "../state/app_state.js";

export interface ToolPointer {
  readonly px: Vec2;
  readonly shift: boolean;
  readonly ctrl: boolean;
}

export interface Tool {
  readonly name: ToolName;
  activate(): void;
  deactivate(): void;
  /** The pointer moved over the canvas without a button. At most 10 calls a second. */
  hover(pointer: ToolPointer): void;
  /** A click (pressed and released within 4 pixels). Returns true when it was used. */
  click(pointer: ToolPointer): boolean;
  doubleClick(pointer: ToolPointer): boolean;
  /** Escape, Enter, Backspace while drawing. Returns true when it was used. */
  key(key: string): boolean;
}
