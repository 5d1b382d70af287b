// Joins the rooms: project, store, engine, scene, tools, panels.
import { StrictMode } from "react";
import { createRoot, type Root } from "react-dom/client";
import type { AppContext } from "../panels/context.js";
import { switchLayer } from "../panels/layers/switch_layer.js";
import { AppView } from "../panels/shell/app_view.js";
import { addViewCommands } from "../panels/shell/view_commands.js";
import { assetUrl, uploadAsset } from "../protocol/assets_client.js";
import { loadBuildings } from "../protocol/buildings_client.js";
import { convertGcpList } from "../protocol/documents_client.js";
import { connect } from "../protocol/link.js";
import { loadProject } from "../protocol/project_client.js";
import { loadRights } from "../protocol/rights_client.js";
import { fetchBytes } from "../scene/load_bytes.js";
import { createScene } from "../scene/viewer_scene.js";
import { CommandTable } from "../state/commands.js";
import { initialState } from "../state/initial.js";
import { Store } from "../state/store.js";
import { createTools } from "../tools/tools.js";
import { keepBuildings } from "./buildings_loader.js";
import { groundLoader } from "./ground_loader.js";
import { watchProject } from "./project_watch.js";
import { requireWebGl2, StartErrorPage } from "./start_error.js";
import { installTestHook } from "./test_hook.js";
import { ViewLog } from "./view_log.js";
import { wireLink } from "./wire_link.js";

/** Set by build.mjs. Asked directly wherever it counts, so that other builds leave the hook out. */
declare const SKYQUILT_TEST_HOOK: boolean;

async function start(root: Root, container: HTMLElement): Promise<void> {
  requireWebGl2();
  dropToken();
  const [project, rights] = await Promise.all([loadProject(), loadRights()]);
  const store = new Store(initialState(project, rights));
  // On a phone the panel would hide half of the first picture.
  if (window.matchMedia("(max-width: 640px)").matches) store.set({ panel: null });
  const commands = new CommandTable();
  const views = SKYQUILT_TEST_HOOK ? new ViewLog() : null;
  const connected = connect();
  const link = views === null ? connected : views.watch(connected);
  wireLink(link, store);
  const scene = createScene({ container, project, store, link });
  const base = { project, store, scene, link, commands };
  const { playback } = createTools({
    ...base,
    ground: groundLoader(project, fetchBytes, (url) => Promise.resolve(url)),
  });
  const assets = { url: assetUrl, upload: uploadAsset };
  const context: AppContext = { ...base, assets, controls: playback, convertGcpList };
  addViewCommands(context);
  // A stop of the tour may switch the layer on before the map has been made.
  store.subscribe(
    ({ play, layers, errorMap }) => play !== null && layers.errorMap && errorMap === null,
    (wanted) => {
      if (wanted) void switchLayer(context, "errorMap", true);
    },
  );
  keepBuildings(store, project, loadBuildings);
  const draw = (changed: boolean): void =>
    root.render(
      <StrictMode>
        <AppView context={context} changed={changed} />
      </StrictMode>,
    );
  draw(false);
  watchProject(store, project, loadProject, () => draw(true));
  if (SKYQUILT_TEST_HOOK && views !== null) installTestHook(context, views);
}

/** The link's token has done its work and must not stay in the address, from where it would be copied or bookmarked. */
function dropToken(): void {
  const url = new URL(window.location.href);
  if (!url.searchParams.has("token")) return;
  url.searchParams.delete("token");
  window.history.replaceState(null, "", url);
}

const ui = document.getElementById("ui");
const stage = document.getElementById("stage");
if (ui !== null && stage !== null) {
  const root = createRoot(ui);
  start(root, stage).catch((error: unknown) => {
    console.warn(error);
    root.render(<StartErrorPage error={error} />);
  });
}
