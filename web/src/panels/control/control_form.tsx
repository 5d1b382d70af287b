// The selected control point: name, coordinates, the photos that should see it.

import { type ReactElement, useEffect, useState } from "react";
import { errorText } from "../../base/abort.js";
import type { Vec3 } from "../../base/vec.js";
import { enuFromMap } from "../../geo/projection.js";
import type { ControlPoint, PhotoSight } from "../../state/app_state.js";
import { type MarkEntry, markEntries, residualPx, withoutPoint, withPoint } from "../../state/control_points.js";
import { usableName } from "../../state/names.js";
import { addNotice } from "../../state/notices.js";
import type { Project } from "../../state/project.js";
import { photoUrl } from "../../state/project.js";
import { useApp, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { NumberField } from "../widgets/number_field.js";
import { MarkDialog } from "./mark_dialog.js";

const SHOWN = 30;

export function ControlForm({ point }: { readonly point: ControlPoint }): ReactElement {
  const { store, project, scene } = useApp();
  const { sights, state } = useSights(point.xyz);
  const [marking, setMarking] = useState<number | null>(null);
  const [all, setAll] = useState(false);
  const entries = markEntries(point, project.photos, sights);
  const setAxis = (axis: 0 | 1 | 2, value: number): void => {
    const xyz: Vec3 = [
      axis === 0 ? value : point.xyz[0],
      axis === 1 ? value : point.xyz[1],
      axis === 2 ? value : point.xyz[2],
    ];
    store.changeDocuments("move control point", (documents) =>
      withPoint(documents, point.name, (old) => ({ ...old, xyz })),
    );
  };
  const remove = (): void => {
    store.changeDocuments("delete control point", (documents) => withoutPoint(documents, point.name));
    store.set({ selectedControl: null });
  };
  const look = (): void => {
    const enu = enuOf(project, point.xyz);
    const m = 40 * project.gsdM + 5;
    if (enu !== null) void scene.frameBox([enu[0] - m, enu[1] - m, enu[2] - m], [enu[0] + m, enu[1] + m, enu[2] + m]);
  };
  const labels = project.crs === null ? (["x", "y", "z"] as const) : (["Easting", "Northing", "Height"] as const);
  return (
    <div className="point-form">
      <NameField point={point} />
      <NumberField label={labels[0]} value={point.xyz[0]} digits={3} unit="m" onChange={(value) => setAxis(0, value)} />
      <NumberField label={labels[1]} value={point.xyz[1]} digits={3} unit="m" onChange={(value) => setAxis(1, value)} />
      <NumberField label={labels[2]} value={point.xyz[2]} digits={3} unit="m" onChange={(value) => setAxis(2, value)} />
      <div className="buttons">
        <button type="button" onClick={look}>
          <Icon name="focus" size={16} /> Look at it
        </button>
        <button type="button" className="danger" onClick={remove}>
          <Icon name="remove" size={16} /> Delete
        </button>
      </div>
      <h4>Mark it in photos</h4>
      <p className="hint" role="status">
        {state === "" ? `${entries.filter((entry) => entry.visible).length} photos should see it.` : state}
      </p>
      <ul className="photo-list">
        {entries.slice(0, all ? entries.length : SHOWN).map((entry) => (
          <MarkRow key={entry.photo.index} entry={entry} onOpen={() => setMarking(entry.photo.index)} />
        ))}
      </ul>
      {entries.length > SHOWN && !all ? (
        <button type="button" className="wide" onClick={() => setAll(true)}>
          Show all {entries.length}
        </button>
      ) : null}
      {marking === null ? null : (
        <MarkDialog
          point={point}
          entries={entries}
          photo={marking}
          onPhoto={setMarking}
          onClose={() => setMarking(null)}
        />
      )}
    </div>
  );
}

function NameField({ point }: { readonly point: ControlPoint }): ReactElement {
  const { store } = useApp();
  const [text, setText] = useState<string | null>(null);
  const commit = (): void => {
    if (text === null) return;
    setText(null);
    const name = usableName(text);
    if (name === null || name === point.name) return;
    if (store.get().documents.controlPoints.some((other) => other.name === name)) {
      addNotice(store, "error", `There is a control point "${name}" already: choose another name.`);
      return;
    }
    store.changeDocuments("rename control point", (documents) =>
      withPoint(documents, point.name, (old) => ({ ...old, name })),
    );
    store.set({ selectedControl: name });
  };
  return (
    <label className="field">
      <span className="field-label">Name</span>
      <span className="field-input">
        <input
          type="text"
          maxLength={64}
          autoComplete="off"
          value={text ?? point.name}
          onChange={(event) => setText(event.currentTarget.value)}
          onBlur={commit}
          onKeyDown={(event) => {
            if (event.key === "Enter") commit();
          }}
        />
      </span>
    </label>
  );
}

function MarkRow({ entry, onOpen }: { readonly entry: MarkEntry; readonly onOpen: () => void }): ReactElement {
  const residual = residualPx(entry);
  return (
    <li>
      <button
        type="button"
        className={entry.visible ? "photo-row" : "photo-row hidden-photo"}
        disabled={!entry.photo.available}
        onClick={onOpen}
      >
        {entry.photo.available ? (
          <img src={photoUrl(entry.photo.index, "thumbnail")} loading="lazy" decoding="async" alt={entry.photo.name} />
        ) : (
          <span className="no-picture">no file</span>
        )}
        <span className="photo-text">
          <span className="photo-name">{entry.photo.name}</span>
          <span className="badges">
            {entry.mark === null ? null : <span className="badge badge-strong">marked</span>}
            {residual === null ? null : <span className="hint">{residual.toFixed(2)} px off</span>}
            {entry.visible ? null : <span className="badge">hidden</span>}
          </span>
        </span>
      </button>
    </li>
  );
}

function enuOf(project: Project, xyz: Vec3): Vec3 | null {
  const enu = project.crs === null ? xyz : enuFromMap(project, xyz);
  return enu?.every(Number.isFinite) === true ? enu : null;
}

/** Photos that should see this place; `state` says why there are none. */
function useSights(xyz: Vec3): { readonly sights: readonly PhotoSight[]; readonly state: string } {
  const { link, project } = useApp();
  const connected = useStore((state) => state.engine.connected);
  const [reply, setReply] = useState<{ sights: readonly PhotoSight[]; state: string }>({ sights: [], state: "" });
  useEffect(() => {
    let wanted = true;
    const show = (sights: readonly PhotoSight[], state: string): void => {
      if (wanted) setReply({ sights, state });
    };
    // Without an answer what is known stays.
    const tell = (state: string): void => {
      if (wanted) setReply(({ sights }) => ({ sights, state }));
    };
    const enu = enuOf(project, xyz);
    if (enu === null || enu.some((value) => Math.abs(value) > 1e6))
      show([], "These coordinates are far from the project: check them.");
    else if (!connected) tell("Not connected: photos that should see the point cannot be found now.");
    else {
      tell("Looking for photos …");
      link.photosAt(enu).then(
        (found) =>
          show(found.photos, found.photos.length === 0 ? "No photo looks at these coordinates: check them." : ""),
        (error: unknown) => tell(errorText(error)),
      );
    }
    return () => {
      wanted = false;
    };
  }, [link, project, connected, xyz]);
  return reply;
}
