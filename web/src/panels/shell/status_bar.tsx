// The line at the bottom: coordinates under the cursor, scale, saving, engine.
import type { ReactElement } from "react";
import { shortVertical } from "../../geo/format.js";
import { useApp, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { ScaleBar } from "./scale_bar.js";
import { cursorText, engineText } from "./status_text.js";

export function StatusBar(): ReactElement {
  return (
    <footer className="status">
      <CursorReadout />
      <span className="spring" />
      <SaveState />
      <ScaleBar />
      <EngineState />
    </footer>
  );
}

function CursorReadout(): ReactElement {
  const { project } = useApp();
  const cursor = useStore((state) => state.readout.cursor);
  const system = project.georeferenced && project.crs !== null ? project.crs.name : "local metres";
  if (cursor === null) return <span className="cursor hint">{system}</span>;
  const text = cursorText(project, cursor);
  return (
    <span className="cursor">
      <span className="status-system">{system}</span>
      <span>{text.first}</span>
      <span>{text.second}</span>
      <span title={project.vertical}>
        {text.height} <span className="status-datum">{shortVertical(project.vertical)}</span>
      </span>
      {text.latLon === "" ? null : <span className="status-latlon">{text.latLon}</span>}
      <span className="status-source">{text.source}</span>
    </span>
  );
}

function SaveState(): ReactElement | null {
  const save = useStore((state) => state.save);
  const rights = useStore((state) => state.rights);
  if (!rights.documents && !rights.tour) {
    return (
      <span className="save" title="This link is for looking: what is drawn or measured stays in this page.">
        Nothing is saved
      </span>
    );
  }
  if (save === "saved") return null;
  const text = save === "failed" ? "Not saved" : save === "saving" ? "Saving …" : "Unsaved";
  return (
    <span className={save === "failed" ? "save save-failed" : "save"} role="status">
      {text}
    </span>
  );
}

const USUAL_PASSES = 3;

function EngineState(): ReactElement {
  const engine = useStore((state) => state.engine);
  const layers = useStore((state) => state.layers);
  const { kind, text, title } = engineText(engine, layers);
  const passes = Array.from(
    { length: engine.passes > 0 ? Math.min(8, engine.passes) : USUAL_PASSES },
    (_, pass) => pass,
  );
  return (
    <span className={`engine engine-${kind}`} title={title} role="status">
      {kind === "lost" ? <Icon name="lost" size={16} /> : null}
      {kind === "waiting" || kind === "working" || kind === "exact" ? (
        <span className="passes" aria-hidden="true">
          {passes.map((pass) => (
            <span key={pass} className={pass <= engine.pass ? "pass done" : "pass"} />
          ))}
        </span>
      ) : null}
      {kind === "exact" ? <Icon name="check" size={16} /> : null}
      <span>{text}</span>
      {kind === "off" && title !== "" ? <span className="engine-reason">{title}</span> : null}
    </span>
  );
}
