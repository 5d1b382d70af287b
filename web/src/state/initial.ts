// The state that a project opens with.
import type { AppState, Documents } from "./app_state.js";
import { NO_BUILDINGS } from "./buildings.js";
import type { Project } from "./project.js";

export const NO_DOCUMENTS: Documents = {
  measurements: [],
  controlPoints: [],
  cameraPath: { keys: [], speedMps: 5 },
};

export function initialState(project: Project): AppState {
  // A young project has neither mesh nor maps: then its points and cameras are what there is to see.
  const bare = project.tiles === null && project.terrain === null;
  return {
    documents: NO_DOCUMENTS,
    tool: "navigate",
    draft: [],
    hover: null,
    volumeBase: "plane",
    volumeBaseHeightM: Number.isFinite(project.groundM) ? project.groundM : 0,
    selected: null,
    selectedControl: null,
    buildings: NO_BUILDINGS,
    selectedBuilding: null,
    hoverBuilding: null,
    navigation: "map",
    panel: "layers",
    layers: {
      surface: true,
      exact: true,
      buildings: false,
      blocks: false,
      cameras: bare,
      points: bare,
      contours: false,
      errorMap: false,
      measurements: true,
      controlPoints: true,
      cameraPath: true,
    },
    clip: { on: false, min: project.min, max: project.max },
    swipe: { on: false, at: 0.5 },
    sights: null,
    compare: null,
    errorMap: null,
    engine: {
      connected: false,
      ready: false,
      reason: "connecting",
      revision: 0,
      exposure: "",
      clients: 0,
      ranks: 1,
      pass: -1,
      passes: 0,
    },
    readout: { cursor: null, metresPerPx: null, headingDeg: 0, pitchDeg: -90, fps: 0 },
    notices: [],
    busy: new Map(),
    save: "saved",
    help: false,
  };
}
