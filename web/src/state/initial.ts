// The state that a project opens with.
import { EMPTY_TOUR } from "../tour/types.js";
import type { AppState, Documents } from "./app_state.js";
import { NO_BUILDINGS } from "./buildings.js";
import type { Project } from "./project.js";
import { CLOSED_TOUR, type Rights } from "./tour_state.js";

export const NO_DOCUMENTS: Documents = {
  measurements: [],
  controlPoints: [],
  cameraPath: { keys: [], speedMps: 5 },
  tour: EMPTY_TOUR,
};

/** Of a server that does not know of rights. */
export const USUAL_RIGHTS: Rights = { documents: true, tour: false };

export function initialState(project: Project, rights: Rights = USUAL_RIGHTS): AppState {
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
    rights,
    tour: CLOSED_TOUR,
    play: null,
    map: null,
    exposureStops: 0,
    shownMeasurements: null,
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
      trust: false,
      measurements: true,
      controlPoints: true,
      cameraPath: true,
      things: true,
    },
    clip: { on: false, min: project.min, max: project.max },
    swipe: { on: false, at: 0.5 },
    sights: null,
    compare: null,
    errorMap: null,
    trust: null,
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
