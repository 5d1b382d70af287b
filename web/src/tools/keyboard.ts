// Keys of the page to commands. What has the focus keeps the keys that it needs itself.
import { Disposer } from "../base/disposer.js";
import type { CommandTable } from "../state/commands.js";

/** What counts of the element that has the focus. */
export interface FocusedElement {
  readonly tagName: string;
  readonly type?: string;
  readonly isContentEditable?: boolean;
  closest?(selector: string): unknown;
}

/** Inputs that are no text: they need only these keys. */
const PLAIN_INPUTS = new Set(["button", "checkbox", "color", "file", "image", "radio", "range", "reset", "submit"]);
const OWN_KEYS = new Set([
  "Enter",
  " ",
  "ArrowUp",
  "ArrowDown",
  "ArrowLeft",
  "ArrowRight",
  "Home",
  "End",
  "PageUp",
  "PageDown",
  "Backspace",
  "Delete",
]);
const PRESSED_BY = new Set(["Enter", " "]);

/** The focused element uses this key itself. */
export function keepsKey(element: FocusedElement | null, key: string): boolean {
  if (element === null) return false;
  if (element.isContentEditable === true || (element.closest?.("dialog[open]") ?? null) !== null) return true;
  switch (element.tagName.toUpperCase()) {
    case "INPUT":
      return PLAIN_INPUTS.has(element.type ?? "text") ? OWN_KEYS.has(key) : true;
    case "TEXTAREA":
    case "SELECT":
      return true;
    case "BUTTON":
    case "A":
    case "SUMMARY":
      return PRESSED_BY.has(key);
    default:
      return false;
  }
}

/** While `first` holds, commands come before what else in the page uses the key, such as the camera. Returns what ends it. */
export function listenToCommandKeys(page: Window, commands: CommandTable, first = () => false): Disposer {
  const disposer = new Disposer();
  const handle = (event: KeyboardEvent): void => {
    // Composing: the keys write one character together, as in Chinese.
    if (event.defaultPrevented || event.isComposing || keepsKey(focusOf(event), event.key)) return;
    // A key that is held repeats only what is harmless.
    if (event.repeat && event.key !== "Backspace" && !event.ctrlKey && !event.metaKey) return;
    // With AltGr other characters are typed; it looks like Ctrl and Alt.
    const altGraph = event.getModifierState("AltGraph");
    const press = {
      key: event.key,
      ctrl: !altGraph && (event.ctrlKey || event.metaKey),
      shift: event.shiftKey,
      alt: !altGraph && event.altKey,
    };
    if (!commands.handleKey(press)) return;
    event.preventDefault();
    if (first()) event.stopPropagation();
  };
  disposer.listen(
    page,
    "keydown",
    (event: KeyboardEvent) => {
      if (first()) handle(event);
    },
    { capture: true },
  );
  disposer.listen(page, "keydown", handle);
  return disposer;
}

function focusOf({ target }: KeyboardEvent): FocusedElement | null {
  return target !== null && isElement(target) ? target : null;
}

function isElement(target: object): target is FocusedElement {
  return "tagName" in target && typeof target.tagName === "string";
}
