// Makes the tools and joins them to the canvas, the keyboard, the commands, the saved documents and the tour.
import { type Clock, systemClock } from "../base/clock.js";
import { Disposer } from "../base/disposer.js";
import { assetUrl } from "../protocol/assets_client.js";
import { loadDocument, saveDocument } from "../protocol/documents_client.js";
import type { ToolName } from "../state/app_state.js";
import { addErrorNotice } from "../state/notices.js";
import type { Store } from "../state/store.js";
import { CanvasPointer } from "./canvas_pointer.js";
import { ControlTool } from "./control_tool.js";
import { type DocumentFiles, DocumentsKeeper } from "./documents_keeper.js";
import { measureTools } from "./measure_tools.js";
import { NavigateTool } from "./navigate_tool.js";
import { PhotosTool } from "./photos_tool.js";
import { createPlayTools } from "./play_tools.js";
import { SurfacePicker } from "./surface_picker.js";
import { ThingTool } from "./thing_tool.js";
import type { Tool, ToolPointer } from "./tool.js";
import { addToolCommands } from "./tool_commands.js";
import type { ToolContext } from "./tool_context.js";
import { addTourCommands } from "./tour_commands.js";
import type { Ground, TourPlayback } from "./tour_playback.js";

/** What tests replace. */
export interface ToolsOptions extends ToolContext {
  readonly clock?: Clock;
  readonly files?: DocumentFiles;
  readonly page?: Window;
  readonly ground?: () => Promise<Ground>;
}

export interface Tools {
  readonly playback: TourPlayback;
  dispose(): void;
}

export function createTools(options: ToolsOptions): Tools {
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
    new ThingTool(options, picker),
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
  const ground = options.ground ?? (() => Promise.resolve({ heights: null, map: null }));
  const { playback } = disposer.own(createPlayTools({ ...options, clock, page, ground, urlOf: assetUrl }));
  const keeper = keepDocuments(options, clock, page, disposer);
  disposer.add(addTourCommands(options, playback, keeper.conflict));
  keeper
    .load()
    .then(() => openTour(store, playback))
    .catch((error: unknown) => addErrorNotice(store, "Saved measurements were not loaded", error));
  return { playback, dispose: () => disposer.dispose() };
}

/** Who may only look came for the tour. */
function openTour(store: Store, playback: TourPlayback): void {
  const { rights, documents } = store.get();
  if (!rights.documents && !rights.tour && documents.tour.stops.length > 0) playback.play();
}

function keepDocuments(
  { project, store, files }: ToolsOptions,
  clock: Clock,
  page: Window,
  disposer: Disposer,
): DocumentsKeeper {
  const keeper = new DocumentsKeeper({
    project,
    store,
    clock,
    files: files ?? { load: loadDocument, save: saveDocument },
  });
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
    if (page.document.visibilityState === "hidden") keeper.flush();
  });
  return keeper;
}
