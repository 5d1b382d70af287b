// Commands of the view and the panels.

import type { AppState, Layers, PanelName } from "../../state/app_state.js";
import { addErrorNotice, addNotice } from "../../state/notices.js";
import type { AppContext } from "../context.js";
import { switchLayer } from "../layers/switch_layer.js";
import { PANELS } from "./panel_names.js";
import { addScreenCommand } from "./screen_command.js";
import { turnNorthUp } from "./turn_north.js";

type ViewContext = Omit<AppContext, "assets" | "controls" | "convertGcpList">;

const LAYERS: readonly { readonly name: keyof Layers; readonly label: string; readonly keys: string[] }[] = [
  { name: "surface", label: "Surface", keys: [] },
  { name: "exact", label: "Exact frames", keys: ["x"] },
  { name: "cameras", label: "Cameras", keys: ["c"] },
  { name: "points", label: "Sparse points", keys: [] },
  { name: "buildings", label: "Buildings", keys: ["h"] },
  { name: "blocks", label: "Blocks", keys: ["b"] },
  { name: "contours", label: "Contours", keys: [] },
  { name: "errorMap", label: "Held-out error", keys: [] },
  { name: "trust", label: "Error to expect", keys: [] },
  { name: "measurements", label: "Measurements", keys: [] },
];
const PANEL_KEYS: Readonly<Partial<Record<PanelName, readonly string[]>>> = { tour: ["u"] };
const always = (): boolean => true;
/** A dialog over the view has its own keys, and so has a tour that is played. */
const free = (state: AppState): boolean => !state.help && state.compare === null && state.play === null;

export function addViewCommands(context: ViewContext): void {
  const { store, scene, project, commands } = context;
  commands.add({ id: "view.north", label: "North up", keys: ["n"], when: free, run: () => turnNorthUp(context) });
  commands.add({
    id: "view.all",
    label: "All in view",
    keys: ["Home"],
    when: free,
    run: () => scene.frameBox(project.min, project.max),
  });
  commands.add({
    id: "view.capture",
    label: "Save the view as a picture (PNG)",
    keys: ["p"],
    when: free,
    run: () => savePicture(context),
  });
  addScreenCommand(context);
  commands.add({
    id: "view.help",
    label: "Keys and commands",
    keys: ["?"],
    when: always,
    run: () => store.update((state) => ({ help: !state.help })),
  });
  commands.add({
    id: "panel.toggle",
    label: "Open or close the panel",
    keys: ["l"],
    when: free,
    run: () => store.update((state) => ({ panel: state.panel === null ? "layers" : null })),
  });
  for (const { name, label } of PANELS) {
    commands.add({
      id: `panel.${name}`,
      label,
      keys: PANEL_KEYS[name] ?? [],
      when: free,
      run: () => store.update((state) => ({ panel: state.panel === name ? null : name })),
    });
  }
  for (const { name, label, keys } of LAYERS) {
    commands.add({ id: `layer.${name}`, label, keys, when: free, run: () => toggleLayer(context, name) });
  }
}

async function toggleLayer(context: ViewContext, name: keyof Layers): Promise<void> {
  const { store, project } = context;
  // Its switch in the panel is off too.
  if (name === "buildings" && (project.buildings?.count ?? 0) === 0) {
    addNotice(store, "info", "There are no buildings to show.");
    return;
  }
  await switchLayer(context, name, !store.get().layers[name]);
}

async function savePicture({ scene, store, project }: ViewContext): Promise<void> {
  try {
    const blob = await scene.capture();
    const url = URL.createObjectURL(blob);
    const link = document.createElement("a");
    link.href = url;
    link.download = `${project.name} ${timeName(new Date())}.png`;
    link.click();
    // The browser reads it after the click.
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
    addNotice(store, "info", `Saved as ${link.download}.`);
  } catch (error) {
    addErrorNotice(store, "The picture could not be saved", error);
  }
}

/** "2026-11-03 14-05-09": sorts by time and has no character that a file system refuses. */
function timeName(time: Date): string {
  const two = (value: number): string => String(value).padStart(2, "0");
  const date = `${time.getFullYear()}-${two(time.getMonth() + 1)}-${two(time.getDate())}`;
  return `${date} ${two(time.getHours())}-${two(time.getMinutes())}-${two(time.getSeconds())}`;
}
