// The tour: its title, stops and things; played from here. Without the right to change it only what there is to see.
import type { ReactElement } from "react";
import { changeTour } from "../../state/tour_changes.js";
import { setTitle } from "../../tour/edit_stops.js";
import { useApp, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { LineField } from "../widgets/line_field.js";
import { TourPlacing } from "./tour_placing.js";
import { TourStopList } from "./tour_stop_list.js";
import { TourThings } from "./tour_things.js";
import { UploadProgress } from "./tour_upload.js";

export function TourPanel(): ReactElement {
  const { store, commands } = useApp();
  const tour = useStore(({ documents }) => documents.tour);
  const { locked, conflict, missing } = useStore((state) => state.tour);
  const empty = tour.stops.length === 0;
  return (
    <>
      <TourPlacing />
      {conflict ? <ConflictCard /> : null}
      <section>
        {locked === null ? (
          <LineField
            label="Title"
            value={tour.title}
            empty
            placeholder="Title of the tour"
            onChange={(title) => changeTour(store, "change title", (old) => setTitle(old, title))}
          />
        ) : (
          <p className="tour-title">{tour.title}</p>
        )}
        <div className="buttons">
          <button type="button" className="primary" disabled={empty} onClick={() => void commands.run("tour.play")}>
            <Icon name="play" size={16} /> Play
          </button>
          {locked === null ? (
            <button type="button" onClick={() => void commands.run("tour.addStop")}>
              <Icon name="add" size={16} /> Add a stop here
            </button>
          ) : null}
        </div>
        <UploadProgress />
        {locked === null ? null : <p className="hint">{locked}</p>}
        {missing.length === 0 ? null : (
          <ul className="hint tour-missing">
            {missing.map((sentence) => (
              <li key={sentence}>{sentence}</li>
            ))}
          </ul>
        )}
        {empty && locked === null ? (
          <p className="hint">
            No stops yet. Move to a view and add it as a stop, give it a title and a text; visitors then go from one
            stop to the next.
          </p>
        ) : null}
        <TourStopList tour={tour} />
      </section>
      {locked === null ? <TourThings tour={tour} /> : null}
    </>
  );
}

function ConflictCard(): ReactElement {
  const { commands } = useApp();
  return (
    <section role="alert">
      <p>
        <strong>Another window has saved the tour.</strong> Your changes are only in this page until you decide.
      </p>
      <div className="buttons">
        <button type="button" onClick={() => void commands.run("tour.takeOther")}>
          Take the other version
        </button>
        <button type="button" onClick={() => void commands.run("tour.keepMine")}>
          Keep mine
        </button>
      </div>
    </section>
  );
}
