// Commands of tools, editing, navigation and camera path. Those of panels and layers are added by the panels.
import { errorText, isAbort } from "../base/abort.js";
import type { AppState, Navigation, ToolName } from "../state/app_state.js";
import { keyPose } from "../state/camera_path.js";
import { withoutMeasurement } from "../state/measurements.js";
import { freeName } from "../state/names.js";
import { addNotice } from "../state/notices.js";
import type { Tool } from "./tool.js";
import type { ToolContext } from "./tool_context.js";

const TOOLS: readonly (readonly [ToolName, string])[] = [
  ["navigate", "Navigate"],
  ["point", "Measure a point"],
  ["distance", "Measure a distance"],
  ["profile", "Measure a height profile"],
  ["area", "Measure an area"],
  ["volume", "Measure a volume"],
  ["photos", "Photos that see a point"],
  ["control", "Place a control point"],
  ["thing", "Place a label or marker of the tour"],
];
const WAYS: readonly (readonly [Navigation, string, string])[] = [
  ["map", "Move like a map", "m"],
  ["fly", "Fly", "g"],
  ["top", "From straight above", "t"],
];

/** A dialog over the view has its own keys, and so has a tour that is played. */
const free = (state: AppState): boolean => !state.help && state.compare === null && state.play === null;
const offered = (name: ToolName, state: AppState): boolean => name !== "thing" || state.tour.locked === null;

/** Returns the function that takes them out again. */
export function addToolCommands(context: ToolContext, activeTool: () => Tool): () => void {
  const { store, commands } = context;
  commands.attach({
    state: () => store.get(),
    onError: (command, error) => {
      if (!isAbort(error)) addNotice(store, "error", `${command.label}: ${errorText(error)}`);
    },
  });
  const ends: (() => void)[] = [];
  const add = (id: string, label: string, keys: string[], when: (state: AppState) => boolean, run: () => void) => {
    ends.push(commands.add({ id, label, keys, when, run }));
  };
  TOOLS.forEach(([name, label], i) => {
    const when = (state: AppState) => free(state) && offered(name, state);
    add(`tool.${name}`, label, [String(i + 1)], when, () => store.set({ tool: name }));
  });
  for (const [name, label, key] of WAYS) {
    add(`navigation.${name}`, label, [key], free, () => store.set({ navigation: name }));
  }
  add("draft.place", "Place a point in the middle of the view", ["."], canPlace, () => {
    // For those who work without a mouse; the scene shows a cross there.
    const { clientWidth, clientHeight } = context.scene.canvas;
    activeTool().click({ px: [clientWidth / 2, clientHeight / 2], shift: false, ctrl: false });
  });
  const drawing = (state: AppState) => free(state) && state.draft.length > 0;
  add("draft.finish", "Finish the line or outline", ["Enter"], drawing, () => void activeTool().key("Enter"));
  add("draft.back", "Take the last point away", ["Backspace"], drawing, () => void activeTool().key("Backspace"));
  add("draft.cancel", "Cancel", ["Escape"], canCancel, () => {
    // First what is being drawn or is selected, then the tool; of a tour that is played its end.
    if (store.get().play !== null) void commands.run("play.leave");
    else if (!activeTool().key("Escape")) store.set({ tool: "navigate" });
  });
  add("edit.undo", "Undo", ["Ctrl+Z"], free, () => {
    if (store.get().draft.length > 0 && activeTool().key("Backspace")) return;
    const label = store.undo();
    if (label !== null) addNotice(store, "info", `Undone: ${label}`);
  });
  add("edit.redo", "Redo", ["Ctrl+Shift+Z", "Ctrl+Y"], free, () => {
    const label = store.redo();
    if (label !== null) addNotice(store, "info", `Done again: ${label}`);
  });
  add(
    "edit.delete",
    "Delete the selected measurement",
    ["Delete"],
    (state) => free(state) && state.selected !== null,
    () => {
      const { selected } = store.get();
      if (selected === null) return;
      store.changeDocuments("delete measurement", (documents) => withoutMeasurement(documents, selected));
      store.set({ selected: null });
    },
  );
  add("path.add", "Add the view to the camera path", ["k"], free, () => addKeyFrame(context));
  return () => {
    for (const end of ends) end();
  };
}

function canCancel(state: AppState): boolean {
  if (state.play !== null) return !state.help && state.compare === null;
  return (
    free(state) &&
    (state.tool !== "navigate" ||
      state.selected !== null ||
      state.selectedBuilding !== null ||
      state.tour.thing !== null)
  );
}

function canPlace(state: AppState): boolean {
  return free(state) && state.tool !== "navigate";
}

function addKeyFrame({ store, scene }: Pick<ToolContext, "store" | "scene">): void {
  store.changeDocuments("add key frame", (documents) => {
    const { keys } = documents.cameraPath;
    const name = freeName(
      "Key",
      keys.map((key) => key.name),
    );
    return { ...documents, cameraPath: { ...documents.cameraPath, keys: [...keys, { name, pose: keyPose(scene) }] } };
  });
  // In its panel it is seen.
  if (store.get().panel === "path") return;
  addNotice(store, "info", `Key frame ${store.get().documents.cameraPath.keys.length} was added to the camera path.`);
}
