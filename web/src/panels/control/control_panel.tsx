// Control points: the list, a form for the selected one, and the photos in which it can be marked.

import { type ChangeEvent, type ReactElement, useState } from "react";
import { errorText } from "../../base/abort.js";
import type { Vec3 } from "../../base/vec.js";
import { mapFromEnu } from "../../geo/projection.js";
import type { ControlPoint } from "../../state/app_state.js";
import { readLoadedPoints } from "../../state/control_file.js";
import { freePointName, mergeControlPoints } from "../../state/control_points.js";
import { addNotice } from "../../state/notices.js";
import type { AppContext } from "../context.js";
import { useApp, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { ControlForm } from "./control_form.js";

const LARGEST_FILE_BYTES = 1024 * 1024;

export function ControlPanel(): ReactElement {
  const context = useApp();
  const { store, project } = context;
  const points = useStore((state) => state.documents.controlPoints);
  const selected = useStore((state) => state.selectedControl);
  const mayLoad = useStore((state) => state.rights.documents);
  return (
    <>
      <p className="hint">
        {project.crs === null ? "Coordinates in local metres" : `Coordinates in ${project.crs.name}`};{" "}
        {project.vertical}. Saved as <code>gcp_list.txt</code> in the project.
      </p>
      <div className="buttons">
        <button type="button" onClick={() => addPoint(context)}>
          <Icon name="add" size={16} /> Add
        </button>
        {mayLoad ? <LoadButton /> : null}
      </div>
      {points.length === 0 ? (
        <p className="hint">
          No control points yet. Add one, load a gcp_list.txt, or take the control tool and click the surface.
        </p>
      ) : (
        <ul className="points">
          {points.map((point) => (
            <li key={point.name} className={point.name === selected ? "point-item selected" : "point-item"}>
              <button
                type="button"
                className="point-row"
                aria-expanded={point.name === selected}
                onClick={() => store.set({ selectedControl: point.name === selected ? null : point.name })}
              >
                <span className="point-name">{point.name}</span>
                <MarkCount point={point} />
              </button>
              {point.name === selected ? <ControlForm point={point} /> : null}
            </li>
          ))}
        </ul>
      )}
    </>
  );
}

function MarkCount({ point }: { readonly point: ControlPoint }): ReactElement {
  const count = point.marks.length;
  // Two rays place a point, the third checks it.
  return (
    <span className={count < 3 ? "badge" : "badge badge-strong"}>
      {count} {count === 1 ? "mark" : "marks"}
    </span>
  );
}

/** In the middle of the view, where a person most likely looks. */
function addPoint({ store, scene, project }: AppContext): void {
  const middle = scene.pickSurface([scene.canvas.clientWidth / 2, scene.canvas.clientHeight / 2]);
  const centre: Vec3 = [(project.min[0] + project.max[0]) / 2, (project.min[1] + project.max[1]) / 2, project.groundM];
  const enu = middle?.enu ?? centre;
  const xyz = mapFromEnu(project, enu) ?? enu;
  const name = freePointName(new Set(store.get().documents.controlPoints.map((point) => point.name)));
  store.changeDocuments("add control point", (documents) => ({
    ...documents,
    controlPoints: [...documents.controlPoints, { name, xyz, marks: [] }],
  }));
  store.set({ selectedControl: name });
}

function LoadButton(): ReactElement {
  const { store, project, convertGcpList } = useApp();
  const [reading, setReading] = useState(false);
  const load = async (event: ChangeEvent<HTMLInputElement>): Promise<void> => {
    const input = event.currentTarget;
    const file = input.files?.[0];
    if (file === undefined) return;
    setReading(true);
    try {
      if (file.size > LARGEST_FILE_BYTES) throw new Error("the file is larger than 1 MiB");
      const text = await convertGcpList(await file.text());
      const taken = store.get().documents.controlPoints.map(({ name }) => name);
      const { points, remark } = readLoadedPoints(text, project, taken);
      store.changeDocuments("load control points", (documents) => ({
        ...documents,
        controlPoints: mergeControlPoints(documents.controlPoints, points),
      }));
      addNotice(store, "info", `${points.length} control points loaded from ${file.name}.`);
      if (remark !== "") addNotice(store, "error", `${file.name}: ${remark}.`);
    } catch (error) {
      addNotice(store, "error", `${file.name}: ${errorText(error)}`);
    } finally {
      setReading(false);
      // The same file can be chosen again after it was corrected.
      input.value = "";
    }
  };
  return (
    <label className="button-like">
      <Icon name="open" size={16} /> Load gcp_list.txt
      <input
        type="file"
        className="sr-only"
        accept=".txt,text/plain"
        disabled={reading}
        onChange={(event) => void load(event)}
      />
    </label>
  );
}
