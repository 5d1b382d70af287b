// Measurements: tools, what they found with ± one standard deviation, export.
import type { ReactElement } from "react";
import { formatArea, formatEstimate, formatLength } from "../../geo/format.js";
import { area, distance } from "../../geo/measure.js";
import type { Measurement, SurfacePoint, ToolName } from "../../state/app_state.js";
import { measurementsCsv } from "../../state/csv.js";
import { writeMeasurements } from "../../state/measurements_file.js";
import { addErrorNotice } from "../../state/notices.js";
import type { Project } from "../../state/project.js";
import type { AppContext } from "../context.js";
import { useStore } from "../use_store.js";
import { keysOf } from "../widgets/command_keys.js";
import { downloadText } from "../widgets/download.js";
import { IconButton } from "../widgets/icon_button.js";
import { MeasureItem } from "./measure_item.js";
import { resultLines } from "./measure_text.js";
import { NextVolumeBase } from "./volume_base.js";

const TOOLS = [
  { name: "point", label: "Point" },
  { name: "distance", label: "Distance" },
  { name: "profile", label: "Height profile" },
  { name: "area", label: "Area" },
  { name: "volume", label: "Volume" },
] as const;

export function MeasurePanel({ context }: { readonly context: AppContext }): ReactElement {
  const { project } = context;
  const measurements = useStore((state) => state.documents.measurements);
  const selected = useStore((state) => state.selected);
  return (
    <>
      <section>
        <Tools context={context} />
        <Draft project={project} />
        <NextVolumeBase context={context} />
      </section>
      <section aria-label="List">
        {measurements.length === 0 ? (
          <p className="hint">Nothing measured yet. Take a tool and click the surface.</p>
        ) : (
          <ul className="points">
            {measurements.map((measurement) => (
              <MeasureItem
                key={measurement.id}
                context={context}
                measurement={measurement}
                selected={measurement.id === selected}
              />
            ))}
          </ul>
        )}
        <LatestResult measurements={measurements} selected={selected} project={project} />
        <ExportButtons context={context} measurements={measurements} />
      </section>
      <section>
        <Explanation project={project} />
      </section>
    </>
  );
}

function Tools({ context }: { readonly context: AppContext }): ReactElement {
  const { store, commands } = context;
  const tool = useStore((state) => state.tool);
  const drawing = useStore((state) => state.draft.length > 0);
  // The history changes only together with the documents.
  useStore((state) => state.documents);
  const { undoLabel, redoLabel } = store.history;
  return (
    <div className="buttons" role="toolbar" aria-label="Measuring tools">
      {TOOLS.map(({ name, label }) => (
        <IconButton
          key={name}
          icon={name}
          label={label}
          side="below"
          keys={keysOf(commands, `tool.${name}`)}
          pressed={tool === name}
          onClick={() => store.set({ tool: tool === name ? "navigate" : name })}
        />
      ))}
      <IconButton
        icon="undo"
        label={undoLabel === null ? "Undo" : `Undo: ${undoLabel}`}
        side="below"
        keys={keysOf(commands, "edit.undo")}
        disabled={undoLabel === null && !drawing}
        onClick={() => void commands.run("edit.undo")}
      />
      <IconButton
        icon="redo"
        label={redoLabel === null ? "Redo" : `Redo: ${redoLabel}`}
        side="left"
        keys={keysOf(commands, "edit.redo")}
        disabled={redoLabel === null}
        onClick={() => void commands.run("edit.redo")}
      />
    </div>
  );
}

/** What to do next with the tool, and the value so far. */
function Draft({ project }: { readonly project: Project }): ReactElement | null {
  const tool = useStore((state) => state.tool);
  const draft = useStore((state) => state.draft);
  const hint = draftHint(tool, draft.length);
  if (hint === null) return null;
  const value = draftValue(tool, draft, project);
  return (
    <p className="hint" role="status">
      {hint}
      {value === "" ? "" : ` So far ${value}.`}
    </p>
  );
}

function draftHint(tool: ToolName, points: number): string | null {
  switch (tool) {
    case "point":
      return "Click the surface.";
    case "distance":
      return points === 0
        ? "Click the first point."
        : "Click the next point; Enter or a double click finishes, Backspace takes one back.";
    case "profile":
      return points === 0
        ? "Click the start of the profile."
        : points === 1
          ? "Click its end."
          : "The engine reads the heights …";
    case "area":
    case "volume":
      return points === 0
        ? "Click the corners one after the other."
        : "Click the next corner; Enter, a double click or the first corner finishes, Backspace takes one back.";
    default:
      return null;
  }
}

function draftValue(tool: ToolName, draft: readonly SurfacePoint[], project: Project): string {
  if (tool === "distance" && draft.length > 1) return formatLength(distance(draft, project.accuracy).slope.value);
  if (tool === "area" && draft.length > 2) return formatArea(area(draft, project.accuracy).plan.value);
  return "";
}

/** The selected result, read out when it changes. */
function LatestResult(props: {
  readonly measurements: readonly Measurement[];
  readonly selected: string | null;
  readonly project: Project;
}): ReactElement {
  const measurement = props.measurements.find(({ id }) => id === props.selected);
  const text =
    measurement === undefined
      ? ""
      : `${measurement.name}. ${resultLines(measurement, props.project)
          .map((line) => `${line.label}: ${line.text}`)
          .join(". ")}`;
  return (
    <p className="sr-only" aria-live="polite">
      {text}
    </p>
  );
}

function ExportButtons(props: {
  readonly context: AppContext;
  readonly measurements: readonly Measurement[];
}): ReactElement | null {
  const { project, store } = props.context;
  if (props.measurements.length === 0) return null;
  const save = (ending: string, type: string, make: () => string): void => {
    try {
      downloadText(`${project.name} measurements.${ending}`, type, make());
    } catch (error) {
      addErrorNotice(store, "The file could not be made", error);
    }
  };
  return (
    <div className="buttons">
      <button type="button" onClick={() => save("csv", "text/csv", () => measurementsCsv(props.measurements, project))}>
        Export CSV
      </button>
      <button
        type="button"
        onClick={() => save("geojson", "application/geo+json", () => writeMeasurements(props.measurements, project))}
      >
        Export GeoJSON
      </button>
    </div>
  );
}

function Explanation({ project }: { readonly project: Project }): ReactElement {
  const { scalePercent, tiltDeg } = project.accuracy;
  const example =
    scalePercent === null
      ? ""
      : ` Here: ${formatEstimate({ value: 100, sigma: scalePercent })} for a length of 100 m from the scale alone.`;
  return (
    <details className="fold-explanation">
      <summary>What ± means</summary>
      <p className="hint">
        One standard deviation. A clicked point is as uncertain along its ray as the field's depth there, and by half a
        pixel across it. Points are taken as independent. Points of the mesh that the field did not confirm have no ±.
      </p>
      <p className="hint">
        The geo-reference adds its scale to lengths (twice to areas, three times to volumes) and its tilt to height
        differences
        {scalePercent === null || tiltDeg === null ? "; it is not known for this project, so it is left out" : ""}.
        {example} Coordinates of points also contain the accuracy of the place. Volumes contain the spread of the depths
        inside and of the outline; over a height or the earlier survey also the vertical accuracy.
      </p>
    </details>
  );
}
