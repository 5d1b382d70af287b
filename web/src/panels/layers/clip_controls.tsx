// The clip box: six faces as sliders and numbers.

import type { ReactElement } from "react";
import type { Vec3 } from "../../base/vec.js";
import type { ClipBox } from "../../state/app_state.js";
import { type Axis, boxAround, type Side, withFace } from "../../state/clip_box.js";
import { addNotice } from "../../state/notices.js";
import type { AppContext } from "../context.js";
import { useApp, useStore } from "../use_store.js";
import { NumberField } from "../widgets/number_field.js";

const FACES: readonly { readonly side: Side; readonly axis: Axis; readonly label: string }[] = [
  { side: "min", axis: 0, label: "West" },
  { side: "max", axis: 0, label: "East" },
  { side: "min", axis: 1, label: "South" },
  { side: "max", axis: 1, label: "North" },
  { side: "min", axis: 2, label: "Bottom" },
  { side: "max", axis: 2, label: "Top" },
];
/** Places across and down the view where "Fit to view" looks for the surface. */
const PROBES = 7;

export function ClipControls(): ReactElement {
  const context = useApp();
  const { store, project, scene } = context;
  const clip = useStore((state) => state.clip);
  const change = (next: ClipBox): void => store.set({ clip: next });
  return (
    <section>
      <h3>Clip box</h3>
      <label className="layer-row">
        <input
          type="checkbox"
          className="switch"
          checked={clip.on}
          onChange={(event) => change({ ...clip, on: event.currentTarget.checked })}
        />
        <span className="layer-label">Show only what is inside</span>
      </label>
      {clip.on ? (
        <>
          <p className="hint">Metres east, north and up of the project's origin.</p>
          {FACES.map(({ side, axis, label }) => (
            <div className="clip-face" key={label}>
              <input
                type="range"
                aria-label={`${label} face`}
                min={project.min[axis]}
                max={project.max[axis]}
                step="any"
                value={clip[side][axis]}
                onChange={(event) => change(withFace(clip, side, axis, Number(event.currentTarget.value)))}
              />
              <NumberField
                label={label}
                value={clip[side][axis]}
                digits={1}
                unit="m"
                onChange={(value) => change(withFace(clip, side, axis, value))}
              />
            </div>
          ))}
          <div className="buttons">
            <button type="button" onClick={() => fitToView(context)}>
              Fit to view
            </button>
            <button type="button" onClick={() => void scene.frameBox(clip.min, clip.max)}>
              Look at box
            </button>
            <button type="button" onClick={() => change({ on: true, min: project.min, max: project.max })}>
              Reset
            </button>
          </div>
        </>
      ) : null}
    </section>
  );
}

function fitToView({ store, scene }: AppContext): void {
  const { clientWidth: w, clientHeight: h } = scene.canvas;
  const before = store.get().clip;
  // What is clipped away cannot be picked, and the box may grow.
  store.set({ clip: { ...before, on: false } });
  const points: Vec3[] = [];
  for (let row = 0; row < PROBES; row++) {
    for (let column = 0; column < PROBES; column++) {
      const point = scene.pickSurface([((column + 0.5) / PROBES) * w, ((row + 0.5) / PROBES) * h]);
      if (point !== null) points.push(point.enu);
    }
  }
  const box = boxAround(points, 2);
  store.set({ clip: box === null ? before : { on: true, ...box } });
  if (box === null) addNotice(store, "info", "No surface in this view: the clip box stays as it is.");
}
