// One label, marker or model.
import { type ReactElement, useState } from "react";
import { changeTour, setTourView } from "../../state/tour_changes.js";
import { removeThing, renameThing, scaleThing, setTarget, showAtStops, turnThing } from "../../tour/edit_things.js";
import type { Thing, Tour } from "../../tour/types.js";
import { useApp } from "../use_store.js";
import { CheckField } from "../widgets/check_field.js";
import { Icon } from "../widgets/icons.js";
import { LineField } from "../widgets/line_field.js";
import { NumberField } from "../widgets/number_field.js";
import { SelectField } from "../widgets/select_field.js";
import { stopOptions, thingText } from "./tour_names.js";
import { lookAtThing } from "./tour_view.js";

interface ThingFormProps {
  readonly tour: Tour;
  readonly thing: Thing;
  readonly onMove: () => void;
}

const NOWHERE = "no stop";

export function TourThingForm({ tour, thing, onMove }: ThingFormProps): ReactElement {
  const context = useApp();
  const { store, scene } = context;
  // It was placed just now: what is typed becomes its text.
  const [fresh] = useState(() => document.activeElement === scene.canvas);
  const { id } = thing;
  const change = (label: string, next: (old: Tour) => Tour, group?: string): void => {
    changeTour(store, label, next, group);
  };
  const remove = (): void => {
    if (changeTour(store, `delete ${thing.kind}`, (old) => removeThing(old, id))) setTourView(store, { thing: null });
  };
  return (
    <div className="point-form">
      <LineField
        label={thing.kind === "model" ? "Name" : "Text"}
        value={thingText(thing)}
        fresh={fresh}
        onChange={(text) => change(`rename ${thing.kind}`, (old) => renameThing(old, id, text))}
      />
      {thing.kind === "marker" ? (
        <SelectField<string>
          label="Leads to"
          value={thing.to ?? NOWHERE}
          options={[[NOWHERE, "No stop"], ...stopOptions(tour)]}
          onChange={(to) => change("change target", (old) => setTarget(old, id, to === NOWHERE ? null : to))}
        />
      ) : null}
      {thing.kind === "model" ? (
        <>
          <NumberField
            label="Turned"
            value={thing.yawDeg}
            digits={1}
            unit="°"
            onChange={(yawDeg) => change("turn model", (old) => turnThing(old, id, yawDeg), `turn ${id}`)}
          />
          <NumberField
            label="Scale"
            value={thing.scale}
            digits={3}
            onChange={(scale) => change("scale model", (old) => scaleThing(old, id, scale), `scale ${id}`)}
          />
        </>
      ) : null}
      {tour.stops.length === 0 ? null : <ShownAt tour={tour} thing={thing} />}
      <div className="buttons">
        <button type="button" onClick={() => lookAtThing(context, thing)}>
          <Icon name="focus" size={16} /> Look at it
        </button>
        <button type="button" onClick={onMove}>
          Move by a click
        </button>
        <button type="button" className="danger" onClick={remove}>
          <Icon name="remove" size={16} /> Delete
        </button>
      </div>
    </div>
  );
}

function ShownAt({ tour, thing }: Omit<ThingFormProps, "onMove">): ReactElement {
  const { store } = useApp();
  const { id, stops } = thing;
  const show = (next: readonly string[] | null): void => {
    changeTour(store, "change where it is shown", (old) => showAtStops(old, id, next));
  };
  const all = tour.stops.map((stop) => stop.id);
  return (
    <>
      <CheckField label="Shown at all stops" checked={stops === null} onChange={(on) => show(on ? null : all)} />
      {stops === null ? null : (
        <fieldset className="plain-set">
          <legend className="sr-only">Stops where it is shown</legend>
          {tour.stops.map((stop, i) => (
            <CheckField
              key={stop.id}
              label={`${i + 1}. ${stop.title}`}
              checked={stops.includes(stop.id)}
              onChange={(on) => show(on ? [...stops, stop.id] : stops.filter((other) => other !== stop.id))}
            />
          ))}
        </fieldset>
      )}
    </>
  );
}
