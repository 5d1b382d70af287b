// One stop: what it says, how it looks, where it leads.
import type { ReactElement } from "react";
import { changeTour, setTourView } from "../../state/tour_changes.js";
import { tourPose } from "../../state/tour_pose.js";
import { changeStop, moveStop, removeStop, type StopChange, setStart } from "../../tour/edit_stops.js";
import { LONGEST_PAUSE_S } from "../../tour/limits.js";
import { usableText } from "../../tour/text_rules.js";
import { useApp } from "../use_store.js";
import { CheckField } from "../widgets/check_field.js";
import { Icon } from "../widgets/icons.js";
import { LineField } from "../widgets/line_field.js";
import { NumberField } from "../widgets/number_field.js";
import type { StopFormProps } from "./stop_form_props.js";
import { isStart } from "./tour_names.js";
import { TourStopLook } from "./tour_stop_look.js";
import { TourStopMedia } from "./tour_stop_media.js";
import { goToStop } from "./tour_view.js";
import { TourBranches, TourNext } from "./tour_ways.js";

export function TourStopForm({ tour, stop, place }: StopFormProps & { readonly place: number }): ReactElement {
  const context = useApp();
  const { store, scene, controls } = context;
  const { id } = stop;
  const change = (label: string, patch: StopChange, group?: string): void => {
    changeTour(store, label, (old) => changeStop(old, id, patch), group);
  };
  const remove = (): void => {
    if (changeTour(store, "delete stop", (old) => removeStop(old, id))) setTourView(store, { stop: null });
  };
  return (
    <div className="point-form">
      <LineField label="Title" value={stop.title} onChange={(title) => change("change title", { title })} />
      <label className="field field-tall">
        <span className="field-label">Text</span>
        <textarea
          rows={4}
          value={stop.text}
          onChange={(event) => change("change text", { text: usableText(event.currentTarget.value) }, `text ${id}`)}
        />
      </label>
      <TourStopMedia tour={tour} stop={stop} />
      <div className="buttons">
        <button type="button" onClick={() => goToStop(context, stop)}>
          <Icon name="focus" size={16} /> Go there
        </button>
        <button type="button" onClick={() => change("set view of stop", { pose: tourPose(scene) })}>
          Set to this view
        </button>
        <button type="button" onClick={() => controls.play(id)}>
          <Icon name="play" size={16} /> Play from here
        </button>
      </div>
      <h4>The way on</h4>
      <TourNext tour={tour} stop={stop} />
      <NumberField
        label="Pause"
        value={stop.pauseS}
        digits={1}
        unit="s"
        onChange={(value) =>
          change("change pause", { pauseS: Math.min(LONGEST_PAUSE_S, Math.max(0, value)) }, `pause ${id}`)
        }
      />
      <TourBranches tour={tour} stop={stop} />
      <TourStopLook tour={tour} stop={stop} />
      <CheckField
        label="The tour begins here"
        checked={isStart(tour, stop)}
        onChange={(on) => changeTour(store, "change beginning", (old) => setStart(old, on ? id : null))}
      />
      <div className="buttons">
        <button
          type="button"
          disabled={place === 0}
          onClick={() => changeTour(store, "move stop", (old) => moveStop(old, id, place - 1))}
        >
          Earlier
        </button>
        <button
          type="button"
          disabled={place === tour.stops.length - 1}
          onClick={() => changeTour(store, "move stop", (old) => moveStop(old, id, place + 1))}
        >
          Later
        </button>
        <button type="button" className="danger" onClick={remove}>
          <Icon name="remove" size={16} /> Delete
        </button>
      </div>
    </div>
  );
}
