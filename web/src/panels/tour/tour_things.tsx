// What stands in the scene: labels, markers, models; added by a click on the surface.
import type { ReactElement } from "react";
import { setTourView } from "../../state/tour_changes.js";
import type { Placing } from "../../state/tour_state.js";
import type { Thing, Tour } from "../../tour/types.js";
import { useApp, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { thingText } from "./tour_names.js";
import { TourThingForm } from "./tour_thing_form.js";
import { UploadButton } from "./tour_upload.js";

const KINDS: Readonly<Record<Thing["kind"], string>> = { label: "label", marker: "marker", model: "model" };

export function TourThings({ tour }: { readonly tour: Tour }): ReactElement {
  const { store } = useApp();
  const opened = useStore((state) => state.tour.thing);
  const placing = useStore((state) => (state.tool === "thing" ? state.tour.placing : null));
  const place = (what: Placing): void => {
    setTourView(store, { placing: what });
    store.set({ tool: "thing" });
  };
  return (
    <section>
      <h3>In the scene</h3>
      <div className="buttons">
        <PlaceButton kind="label" placing={placing} onPlace={place} />
        <PlaceButton kind="marker" placing={placing} onPlace={place} />
        <UploadButton kind="model" label="Model" onDone={(asset) => place({ kind: "model", asset })} />
      </div>
      {tour.things.length === 0 && placing === null ? (
        <p className="hint">
          Labels name things, markers can lead to a stop, models (GLB) stand where they are placed.
        </p>
      ) : null}
      <ul className="points tour-things">
        {tour.things.map((thing) => (
          <li key={thing.id} className={thing.id === opened ? "point-item selected" : "point-item"}>
            <button
              type="button"
              className="point-row"
              aria-expanded={thing.id === opened}
              onClick={() => setTourView(store, { thing: thing.id === opened ? null : thing.id, stop: null })}
            >
              <span className="point-name">{thingText(thing)}</span>
              <span className="badge">{KINDS[thing.kind]}</span>
            </button>
            {thing.id === opened ? (
              <TourThingForm tour={tour} thing={thing} onMove={() => place({ kind: "move", thing: thing.id })} />
            ) : null}
          </li>
        ))}
      </ul>
    </section>
  );
}

interface PlaceButtonProps {
  readonly kind: "label" | "marker";
  readonly placing: Placing | null;
  readonly onPlace: (placing: Placing) => void;
}

function PlaceButton({ kind, placing, onPlace }: PlaceButtonProps): ReactElement {
  return (
    <button type="button" aria-pressed={placing?.kind === kind} onClick={() => onPlace({ kind })}>
      <Icon name={kind === "label" ? "label" : "point"} size={16} /> {kind === "label" ? "Label" : "Marker"}
    </button>
  );
}
