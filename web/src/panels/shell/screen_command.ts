// The whole screen for the page.
import type { CommandTable } from "../../state/commands.js";
import { addNotice } from "../../state/notices.js";
import type { Store } from "../../state/store.js";

interface ScreenContext {
  readonly store: Store;
  readonly commands: CommandTable;
}

export function addScreenCommand({ store, commands }: ScreenContext): void {
  commands.add({
    id: "view.screen",
    label: "Full screen",
    keys: ["f"],
    when: () => true,
    run: () => toggleFullScreen(store),
  });
}

async function toggleFullScreen(store: Store): Promise<void> {
  try {
    if (document.fullscreenElement === null) await document.documentElement.requestFullscreen();
    else await document.exitFullscreen();
  } catch {
    addNotice(store, "info", "The browser did not allow full screen.");
  }
}
