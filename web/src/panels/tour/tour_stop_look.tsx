// How the view looks at a stop: brightness, layers, measurements.
import type { ReactElement } from "react";
import { changeTour } from "../../state/tour_changes.js";
import { changeStop, type StopChange } from "../../tour/edit_stops.js";
import { EXPOSURE_STOPS, MOST_MEASUREMENTS } from "../../tour/limits.js";
import { LAYER_NAMES } from "../../tour/types.js";
import { useApp, useStore } from "../use_store.js";
import { CheckField } from "../widgets/check_field.js";
import { NumberField } from "../widgets/number_field.js";
import type { StopFormProps } from "./stop_form_props.js";
import { layersText } from "./tour_names.js";

export function TourStopLook({ stop }: StopFormProps): ReactElement {
  const { store } = useApp();
  const measurements = useStore(({ documents }) => documents.measurements);
  const change = (label: string, patch: StopChange, group?: string): void => {
    changeTour(store, label, (old) => changeStop(old, stop.id, patch), group);
  };
  const takeLayers = (): void => {
    const { layers } = store.get();
    change("set layers", { layers: Object.fromEntries(LAYER_NAMES.map((name) => [name, layers[name]])) });
  };
  const show = (id: string, on: boolean): void => {
    const others = stop.measurements.filter((other) => other !== id);
    change("choose measurements", { measurements: on ? [...others, id].slice(-MOST_MEASUREMENTS) : others });
  };
  const { exposureStops } = stop;
  return (
    <details className="tour-look">
      <summary>Look of the view</summary>
      <CheckField
        label="Own brightness"
        checked={exposureStops !== null}
        onChange={(on) => change("change brightness", { exposureStops: on ? 0 : null })}
      />
      {exposureStops === null ? null : (
        <NumberField
          label="Brighter"
          value={exposureStops}
          digits={1}
          unit="stops"
          onChange={(value) =>
            change(
              "change brightness",
              { exposureStops: Math.min(EXPOSURE_STOPS.most, Math.max(EXPOSURE_STOPS.least, value)) },
              `brightness ${stop.id}`,
            )
          }
        />
      )}
      <p className="hint">{stop.layers === null ? "Layers as they are in the viewer." : layersText(stop.layers)}</p>
      <div className="buttons">
        <button type="button" onClick={takeLayers}>
          Layers as they are now
        </button>
        {stop.layers === null ? null : (
          <button type="button" onClick={() => change("leave layers alone", { layers: null })}>
            Leave them alone
          </button>
        )}
      </div>
      {measurements.length === 0 ? null : (
        <fieldset className="plain-set">
          <legend className="hint">Measurements to show</legend>
          {measurements.map(({ id, name }) => (
            <CheckField
              key={id}
              label={name}
              checked={stop.measurements.includes(id)}
              onChange={(on) => show(id, on)}
            />
          ))}
        </fieldset>
      )}
    </details>
  );
}
