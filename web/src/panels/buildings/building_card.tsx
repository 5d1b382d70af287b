// All that is known of the chosen building.
import type { ReactElement } from "react";
import type { Building, BuildingSet } from "../../state/buildings.js";
import { useApp } from "../use_store.js";
import { IconButton } from "../widgets/icon_button.js";
import { Icon } from "../widgets/icons.js";
import { copyBuilding, lookAtBuilding, showPhotosOf } from "./building_actions.js";
import { buildingLines, measuresNote, ROOF_LABELS } from "./building_text.js";

interface BuildingCardProps {
  readonly building: Building;
  readonly set: BuildingSet;
  /** Those before and after it in the table. */
  readonly previous: Building | null;
  readonly next: Building | null;
}

export function BuildingCard({ building, set, previous, next }: BuildingCardProps): ReactElement {
  const context = useApp();
  const { store, project } = context;
  const choose = (other: Building | null): void => store.set({ selectedBuilding: other?.id ?? null });
  return (
    <section className="building-card" aria-label={`Building ${building.id}`}>
      <header className="building-head">
        <h3 role="status">Building {building.id}</h3>
        <span className="badges">
          <span className="badge badge-strong">{ROOF_LABELS[building.roof]}</span>
          {building.accepted ? null : <span className="badge badge-warn">to check</span>}
        </span>
        <span className="spring" />
        <IconButton
          icon="previous"
          label="Previous building"
          side="left"
          disabled={previous === null}
          onClick={() => choose(previous)}
        />
        <IconButton
          icon="next"
          label="Next building"
          side="left"
          disabled={next === null}
          onClick={() => choose(next)}
        />
        <IconButton icon="close" label="Choose no building" side="left" onClick={() => choose(null)} />
      </header>
      {building.note === "" ? null : (
        <p className="building-note">
          <Icon name="warning" size={16} /> {sentence(building.note)}
        </p>
      )}
      <div className="buttons">
        <button type="button" onClick={() => lookAtBuilding(context, building)}>
          <Icon name="focus" size={16} /> Look at it
        </button>
        <button type="button" onClick={() => void showPhotosOf(context, building)}>
          <Icon name="photos" size={16} /> Photos of it
        </button>
        <button type="button" onClick={() => void copyBuilding(context, building)}>
          <Icon name="copy" size={16} /> Copy
        </button>
      </div>
      <dl className="facts">
        {buildingLines(building, set, project).map(({ label, text }) => (
          <div className="fact" key={label}>
            <dt>{label}</dt>
            <dd>{text}</dd>
          </div>
        ))}
      </dl>
      <p className="hint">{measuresNote(set, project)}</p>
    </section>
  );
}

/** Notes begin with a small letter. */
function sentence(note: string): string {
  return `${note.slice(0, 1).toUpperCase()}${note.slice(1)}${/[.!?]$/.test(note) ? "" : "."}`;
}
