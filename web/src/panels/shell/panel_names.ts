// The panels in the order of their tabs.
import type { PanelName } from "../../state/app_state.js";

export const PANELS: readonly { readonly name: PanelName; readonly label: string }[] = [
  { name: "layers", label: "Layers" },
  { name: "measure", label: "Measurements" },
  { name: "buildings", label: "Buildings" },
  { name: "photos", label: "Photos" },
  { name: "control", label: "Control points" },
  { name: "path", label: "Camera path" },
  { name: "tour", label: "Tour" },
  { name: "about", label: "About this project" },
];
