// The page of an exported tour: everything comes from the folder that it lies in, also on file:// and without the program.
import { createRoot, type Root } from "react-dom/client";
import type { AppContext } from "../panels/context.js";
import { openOfflineTour } from "../protocol/offline_tour.js";
import { openPackedFiles } from "../protocol/packed_scripts.js";
import { createScene } from "../scene/viewer_scene.js";
import { CommandTable } from "../state/commands.js";
import { initialState, NO_DOCUMENTS } from "../state/initial.js";
import { addNotice } from "../state/notices.js";
import { Store } from "../state/store.js";
import { poseOf } from "../tour/route.js";
import { firstStop } from "../tour/types.js";
import { keepBuildings } from "./buildings_loader.js";
import { buildingsOf, bytesOf, readExportedTour } from "./exported_tour.js";
import { requireWebGl2, StartErrorPage } from "./start_error.js";
import { installTestHook } from "./test_hook.js";
import { ViewLog } from "./view_log.js";
import { wireLink } from "./wire_link.js";

declare const SKYQUILT_TEST_HOOK: boolean | undefined;

const withTestHook = typeof SKYQUILT_TEST_HOOK !== "undefined" && SKYQUILT_TEST_HOOK;

async function start(root: Root, container: HTMLElement): Promise<void> {
  // The scripts of files call what this installs.
  const files = openPackedFiles();
  requireWebGl2();
  const { project, tour, measurements, pictures } = await readExportedTour(files);
  document.title = tour.title === "" ? project.name : tour.title;
  const store = new Store({ ...initialState(project), panel: null, documents: { ...NO_DOCUMENTS, measurements } });
  const stops = tour.stops.map(({ id, pose }) => ({ id, ...pose }));
  const offline = openOfflineTour({ files, stops, pictures, failed: (text) => addNotice(store, "error", text) });
  const views = withTestHook ? new ViewLog() : null;
  const link = views === null ? offline : views.watch(offline);
  wireLink(link, store);
  const scene = createScene({ container, project, store, link, loadBytes: bytesOf(files) });
  keepBuildings(store, project, buildingsOf(files));
  const first = firstStop(tour);
  if (first !== null) void scene.flyTo(poseOf(first.pose), 0);
  root.render(null);
  const context: AppContext = { project, store, scene, link, commands: new CommandTable() };
  if (views !== null) installTestHook(context, views);
}

const ui = document.getElementById("ui");
const stage = document.getElementById("stage");
if (ui !== null && stage !== null) {
  const root = createRoot(ui);
  start(root, stage).catch((error: unknown) => {
    console.warn(error);
    root.render(<StartErrorPage error={error} title="The tour cannot be shown" />);
  });
}
