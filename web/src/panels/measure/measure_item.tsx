// One measurement in the list; the selected one is unfolded.
import type { ReactElement } from "react";
import type { Vec3 } from "../../base/vec.js";
import { formatEstimate, formatLength } from "../../geo/format.js";
import { outlineOffsetM } from "../../geo/heights.js";
import type { Measurement } from "../../state/app_state.js";
import { profileCsv } from "../../state/csv.js";
import { changeMeasurement, withoutMeasurement } from "../../state/measurements.js";
import { addNotice } from "../../state/notices.js";
import type { Project } from "../../state/project.js";
import type { AppContext } from "../context.js";
import { downloadText } from "../widgets/download.js";
import { Icon } from "../widgets/icons.js";
import { TextField } from "../widgets/text_field.js";
import { deviationNote, measurementText, resultLines } from "./measure_text.js";
import { ProfileChart } from "./profile_chart.js";
import { FinishedVolumeBase } from "./volume_base.js";

interface MeasureItemProps {
  readonly context: AppContext;
  readonly measurement: Measurement;
  readonly selected: boolean;
}

export function MeasureItem({ context, measurement, selected }: MeasureItemProps): ReactElement {
  const { store } = context;
  return (
    <li className={selected ? "point-item selected" : "point-item"}>
      <button
        type="button"
        className="point-row"
        aria-expanded={selected}
        onClick={() => store.set({ selected: selected ? null : measurement.id })}
      >
        <span className="point-name">{measurement.name}</span>
        <span className="badge">{mainValue(measurement, context.project)}</span>
      </button>
      {selected ? <Details context={context} measurement={measurement} /> : null}
    </li>
  );
}

function mainValue(measurement: Measurement, project: Project): string {
  switch (measurement.kind) {
    case "point":
      return resultLines(measurement, project).find(({ label }) => label === "Height" || label === "z")?.text ?? "";
    case "distance":
      return formatEstimate(measurement.result.slope);
    case "profile":
      return formatLength(measurement.lengthM);
    case "area":
      return formatEstimate(measurement.result.plan, "area");
    case "volume":
      return formatEstimate(measurement.result.net, "volume");
    default:
      return measurement satisfies never;
  }
}

function Details({ context, measurement }: Omit<MeasureItemProps, "selected">): ReactElement {
  const { store, scene, project } = context;
  const note = deviationNote(measurement, project);
  // The base of a volume has a field of its own below.
  const lines = resultLines(measurement, project).filter(({ label }) => label !== "Base");
  const rename = (name: string): void =>
    store.changeDocuments("rename measurement", (documents) =>
      changeMeasurement(documents, measurement.id, (old) => ({ ...old, name })),
    );
  const remove = (): void => {
    store.changeDocuments("delete measurement", (documents) => withoutMeasurement(documents, measurement.id));
    store.set({ selected: null });
  };
  const look = (): void => {
    const { min, max } = boxOf(measurement, project.gsdM);
    void scene.frameBox(min, max);
  };
  return (
    <div className="point-form">
      <TextField label="Name" value={measurement.name} onChange={rename} />
      <dl className="facts">
        {lines.map(({ label, text }) => (
          <div className="fact" key={label}>
            <dt>{label}</dt>
            <dd>{text}</dd>
          </div>
        ))}
      </dl>
      {note === "" ? null : <p className="hint">{note}</p>}
      {measurement.kind === "volume" ? <FinishedVolumeBase context={context} volume={measurement} /> : null}
      {measurement.kind === "profile" ? (
        <ProfileChart
          name={measurement.name}
          profile={measurement}
          offsetM={outlineOffsetM(project, measurement.points)}
        />
      ) : null}
      <div className="buttons">
        <button type="button" onClick={look}>
          <Icon name="focus" size={16} /> Look at it
        </button>
        <button type="button" onClick={() => void copyResult(context, measurement)}>
          <Icon name="copy" size={16} /> Copy
        </button>
        {measurement.kind === "profile" ? (
          <button
            type="button"
            onClick={() =>
              downloadText(
                `${measurement.name}.csv`,
                "text/csv",
                profileCsv(measurement, outlineOffsetM(project, measurement.points)),
              )
            }
          >
            Export samples
          </button>
        ) : null}
        <button type="button" className="danger" onClick={remove}>
          <Icon name="remove" size={16} /> Delete
        </button>
      </div>
    </div>
  );
}

async function copyResult({ store, project }: AppContext, measurement: Measurement): Promise<void> {
  try {
    // Browsers offer the clipboard only to pages of this computer or by HTTPS.
    await navigator.clipboard.writeText(measurementText(measurement, project));
    addNotice(store, "info", `${measurement.name} was copied.`);
  } catch {
    addNotice(store, "info", "The browser did not allow copying: export the measurements as CSV.");
  }
}

/** With some room around it. */
function boxOf({ points }: Measurement, gsdM: number): { readonly min: Vec3; readonly max: Vec3 } {
  const margin = 40 * gsdM + 2;
  const edge = (pick: (...values: number[]) => number, by: number): Vec3 => {
    const axis = (i: 0 | 1 | 2) => points.reduce((value, { enu }) => pick(value, enu[i]), points[0]?.enu[i] ?? 0) + by;
    return [axis(0), axis(1), axis(2)];
  };
  return { min: edge(Math.min, -margin), max: edge(Math.max, margin) };
}
