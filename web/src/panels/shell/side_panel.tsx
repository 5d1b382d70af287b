// The tabs at the right edge and the one panel that is open.
import type { ReactElement } from "react";
import type { PanelName } from "../../state/app_state.js";
import { BuildingsPanel } from "../buildings/buildings_panel.js";
import { ControlPanel } from "../control/control_panel.js";
import { LayersPanel } from "../layers/layers_panel.js";
import { MeasurePanel } from "../measure/measure_panel.js";
import { PathPanel } from "../path/path_panel.js";
import { PhotosPanel } from "../photos/photos_panel.js";
import { TourPanel } from "../tour/tour_panel.js";
import { useApp, useStore } from "../use_store.js";
import { keysOf } from "../widgets/command_keys.js";
import { IconButton } from "../widgets/icon_button.js";
import { AboutPanel } from "./about_panel.js";
import { PANELS } from "./panel_names.js";

export function PanelTabs(): ReactElement {
  const { store, commands } = useApp();
  const panel = useStore((state) => state.panel);
  return (
    <div className="tabs card" role="toolbar" aria-label="Panels" aria-orientation="vertical">
      {PANELS.map(({ name, label }) => (
        <IconButton
          key={name}
          icon={name}
          label={label}
          side="left"
          keys={keysOf(commands, `panel.${name}`)}
          pressed={panel === name}
          onClick={() => store.set({ panel: panel === name ? null : name })}
        />
      ))}
      <span className="toolbar-rule" />
      <IconButton
        icon="help"
        label="Keys and commands"
        side="left"
        keys={keysOf(commands, "view.help")}
        onClick={() => store.set({ help: true })}
      />
    </div>
  );
}

export function SidePanel(): ReactElement | null {
  const { store } = useApp();
  const panel = useStore((state) => state.panel);
  if (panel === null) return null;
  const label = PANELS.find(({ name }) => name === panel)?.label ?? "";
  return (
    <aside className="panel card" aria-label={label}>
      <div className="panel-inner">
        <header className="panel-head">
          <h2>{label}</h2>
          <IconButton icon="close" label="Close the panel" side="left" onClick={() => store.set({ panel: null })} />
        </header>
        <div className="panel-body">
          <PanelContent panel={panel} />
        </div>
      </div>
    </aside>
  );
}

function PanelContent({ panel }: { readonly panel: PanelName }): ReactElement {
  const context = useApp();
  switch (panel) {
    case "layers":
      return <LayersPanel />;
    case "measure":
      return <MeasurePanel context={context} />;
    case "buildings":
      return <BuildingsPanel />;
    case "photos":
      return <PhotosPanel />;
    case "control":
      return <ControlPanel />;
    case "path":
      return <PathPanel context={context} />;
    case "tour":
      return <TourPanel />;
    case "about":
      return <AboutPanel />;
    default:
      return panel satisfies never;
  }
}
