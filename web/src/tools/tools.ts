// Makes the tools and joins them to the canvas, the keyboard, the commands and the saved documents.
import { type Clock, systemClock } from "../base/clock.js";
import { Disposer } from "../base/disposer.js";
import { loadDocument, saveDocument } from "../protocol/documents_client.js";
import type { ToolName } from "../state/app_state.js";
import { addErrorNotice } from "../state/notices.js";
import { CanvasPointer } from "./canvas_pointer.js";
import { ControlTool } from "./control_tool.js";
import { type DocumentFiles, DocumentsKeeper } from "./documents_keeper.js";
import { listenToCommandKeys } from "./keyboard.js";
import { measureTools } from "./measure_tools.js";
import { NavigateTool } from "./navigate_tool.js";
import { PhotosTool } from "./photos_tool.js";
import { SurfacePicker } from "./surface_picker.js";
import type { Tool, ToolPointer } from "./tool.js";
import { addToolCommands } from "./tool_commands.js";
import type { ToolContext } from "./tool_context.js";

/** What tests replace. */
export interface ToolsOptions extends ToolContext {
  readonly clock?: Clock;
  readonly files?: DocumentFiles;
  readonly page?: Window;
}

export function createTools(options: ToolsOptions): { dispose(): void } {
  const { store, scene } = options;
  const clock = options.clock ?? systemClock;
  const page = options.page ?? window;
  const disposer = new Disposer();

  const picker = new SurfacePicker(options);
  const navigate = new NavigateTool(options);
  const tools = new Map<ToolName, Tool>();
  for (const tool of [
    navigate,
    ...measureTools(options, picker),
    new PhotosTool(options, picker),
    new ControlTool(options, picker),
  ]) {
    tools.set(tool.name, tool);
  }
  let active: Tool = tools.get(store.get().tool) ?? navigate;
  active.activate();
  disposer.add(
    store.subscribe(
      (state) => state.tool,
      (name) => {
        active.deactivate();
        active = tools.get(name) ?? navigate;
        active.activate();
      },
    ),
  );

  const hover = (pointer: ToolPointer | null) => {
    const cursor = pointer === null ? null : scene.pickSurface(pointer.px);
    const { readout, hover: shown, hoverBuilding } = store.get();
    if (cursor !== readout.cursor) store.set({ readout: { ...readout, cursor } });
    if (pointer !== null) active.hover(pointer);
    else if (shown !== null || hoverBuilding !== null) store.set({ hover: null, hoverBuilding: null });
  };
  const pointer = disposer.own(
    new CanvasPointer(
      scene.canvas,
      {
        click: (at) => void active.click(at),
        doubleClick: (at) => void active.doubleClick(at),
        hover,
      },
      clock,
    ),
  );
  // The camera moves below a pointer that stands still.
  disposer.add(
    store.subscribe(
      ({ readout }) => `${readout.headingDeg} ${readout.pitchDeg} ${readout.metresPerPx}`,
      () => pointer.refresh(),
    ),
  );

  disposer.add(addToolCommands(options, () => active));
  disposer.own(listenToCommandKeys(page, options.commands));
  disposer.add(keepDocuments(options, clock, page));
  return { dispose: () => disposer.dispose() };
}

function keepDocuments({ project, store, files }: ToolsOptions, clock: Clock, page: Window): () => void {
  const keeper = new DocumentsKeeper({
    project,
    store,
    clock,
    files: files ?? { load: loadDocument, save: saveDocument },
  });
  const disposer = new Disposer();
  disposer.own(keeper);
  disposer.listen(page, "beforeunload", (event: BeforeUnloadEvent) => {
    if (!keeper.unsaved) return;
    event.preventDefault();
    // Older browsers ask only when this is set.
    event.returnValue = "";
  });
  disposer.listen(page, "pagehide", () => keeper.flush());
  // On phones a page in the background may be ended without another word.
  disposer.listen(page, "visibilitychange", () => {
    if (page.document.visibilityState === "hidden") keeper.hurry();
  });
  keeper.load().catch((error: unknown) => addErrorNotice(store, "Saved measurements were not loaded", error));
  return () => disposer.dispose();
}
