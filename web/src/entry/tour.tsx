// The page of an exported tour: everything comes from the folder that it lies in, also on file:// and without the program.
import { StrictMode } from "react";
import { createRoot, type Root } from "react-dom/client";
import { systemClock } from "../base/clock.js";
import type { PlayContext } from "../panels/context.js";
import { TourPage } from "../panels/play/tour_page.js";
import { addScreenCommand } from "../panels/shell/screen_command.js";
import { assetUrl } from "../protocol/assets_client.js";
import { openOfflineTour } from "../protocol/offline_tour.js";
import { openPackedFiles } from "../protocol/packed_scripts.js";
import { createScene } from "../scene/viewer_scene.js";
import { CommandTable } from "../state/commands.js";
import { initialState, NO_DOCUMENTS } from "../state/initial.js";
import { addNotice } from "../state/notices.js";
import { Store } from "../state/store.js";
import { CLOSED_TOUR, NO_TOUR_RIGHT } from "../state/tour_state.js";
import { createPlayTools } from "../tools/play_tools.js";
import { keepBuildings } from "./buildings_loader.js";
import { buildingsOf, bytesOf, type ExportedTour, readExportedTour } from "./exported_tour.js";
import { groundLoader } from "./ground_loader.js";
import { PictureUrls } from "./picture_urls.js";
import { dropPoster } from "./poster.js";
import { requireWebGl2, StartErrorPage } from "./start_error.js";
import { installTestHook } from "./test_hook.js";
import { ViewLog } from "./view_log.js";
import { wireLink } from "./wire_link.js";

/** Set by build.mjs. Asked directly wherever it counts, so that other builds leave the hook out. */
declare const SKYQUILT_TEST_HOOK: boolean;

async function start(root: Root, container: HTMLElement): Promise<void> {
  // The scripts of files call what this installs.
  const files = openPackedFiles();
  // Asked for before the graphics card is, which takes its time as well.
  const reading = readExportedTour(files);
  reading.catch(() => {});
  requireWebGl2();
  const exported = await reading;
  const { project, tour, pictures } = exported;
  const store = openStore(exported);
  const stops = tour.stops.map(({ id, pose }) => ({ id, ...pose }));
  const offline = openOfflineTour({ files, stops, pictures, failed: (text) => addNotice(store, "error", text) });
  const views = SKYQUILT_TEST_HOOK ? new ViewLog() : null;
  const link = views === null ? offline : views.watch(offline);
  wireLink(link, store);
  const loadBytes = bytesOf(files);
  const scene = createScene({ container, project, store, link, loadBytes });
  const commands = new CommandTable();
  const urls = new PictureUrls(loadBytes);
  const mapUrl = (url: string) => urls.get(url).catch(() => null);
  const { playback } = createPlayTools({
    store,
    scene,
    commands,
    clock: systemClock,
    page: window,
    urlOf: assetUrl,
    ground: groundLoader(project, loadBytes, mapUrl),
  });
  addScreenCommand({ store, commands });
  keepBuildings(store, project, buildingsOf(files));
  store.subscribe(
    ({ play }) => play?.stop?.id ?? null,
    (stop) => {
      if (stop !== null) offline.prepare(stop);
    },
  );
  playback.play();
  dropPoster(store, link, scene.whenIdle());
  const assets = { url: (asset: string) => urls.get(assetUrl(asset)) };
  const context: PlayContext = { project, store, scene, commands, assets, controls: playback };
  root.render(
    <StrictMode>
      <TourPage context={context} />
    </StrictMode>,
  );
  if (SKYQUILT_TEST_HOOK && views !== null) installTestHook({ project, store, scene, commands, link }, views);
}

/** Nothing is changed here, so nothing is open but the tour. */
function openStore({ project, tour, measurements, missing }: ExportedTour): Store {
  if (tour.stops.length === 0) {
    throw new Error("the tour has no stops: add some with `skyquilt view --edit` and export it again");
  }
  return new Store({
    ...initialState(project, { documents: false, tour: false }),
    panel: null,
    documents: { ...NO_DOCUMENTS, tour, measurements },
    tour: { ...CLOSED_TOUR, locked: NO_TOUR_RIGHT, missing },
  });
}

const ui = document.getElementById("ui");
const stage = document.getElementById("stage");
if (ui !== null && stage !== null) {
  const root = createRoot(ui);
  start(root, stage).catch((error: unknown) => {
    console.warn(error);
    document.getElementById("poster")?.remove();
    root.render(<StartErrorPage error={error} title="The tour cannot be shown" />);
  });
}
