// Everything around the 3-D view: tools, panels, status, dialogs, messages.
import { type ReactElement, useEffect } from "react";
import { AppProvider } from "../app_provider.js";
import type { AppContext } from "../context.js";
import { SwipeHandle } from "../layers/swipe_handle.js";
import { PhotoCompareView } from "../photos/photo_compare.js";
import { ExposureFilter } from "../play/exposure_filter.js";
import { TourPlayer } from "../play/tour_player.js";
import { useStore } from "../use_store.js";
import { Notices } from "../widgets/notices.js";
import { BusyList } from "./busy_list.js";
import { HelpDialog } from "./help_dialog.js";
import { PanelTabs, SidePanel } from "./side_panel.js";
import { StatusBar } from "./status_bar.js";
import { Toolbar } from "./toolbar.js";
import { ViewControls } from "./view_controls.js";

interface AppViewProps {
  readonly context: AppContext;
  /** The files of the project are newer than what is shown. */
  readonly changed?: boolean;
}

export function AppView({ context, changed = false }: AppViewProps): ReactElement {
  const { canvas } = context.scene;
  const { name } = context.project;
  useEffect(() => {
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", `3-D view of ${name}. Question mark lists the keys.`);
    document.title = `${name} – Skyquilt`;
  }, [canvas, name]);
  return (
    <AppProvider value={context}>
      <ExposureFilter />
      <ViewOrTour name={name} changed={changed} />
      <PhotoCompareView />
      <HelpDialog />
    </AppProvider>
  );
}

function ViewOrTour({ name, changed }: { readonly name: string; readonly changed: boolean }): ReactElement {
  const playing = useStore((state) => state.play !== null);
  if (playing) return <TourPlayer />;
  return (
    <>
      <h1 className="sr-only">{name}</h1>
      <SwipeHandle />
      <div className="frame">
        <Toolbar />
        <main className="stage-area">
          <ViewControls />
          <div className="messages">
            {changed ? <ChangedCard /> : null}
            <BusyList />
            <Notices />
          </div>
        </main>
        <SidePanel />
        <PanelTabs />
        <StatusBar />
      </div>
    </>
  );
}

function ChangedCard(): ReactElement {
  return (
    <div className="notice notice-info card" role="status">
      <p>The project has changed. Reload the page to see its new surface and numbers.</p>
      <button type="button" className="primary" onClick={() => window.location.reload()}>
        Reload
      </button>
    </div>
  );
}
