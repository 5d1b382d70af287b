// Buildings: a table of all, the measures of the chosen one, and the files to take away.
import { type ReactElement, useMemo, useState } from "react";
import { type BuildingSet, findBuilding } from "../../state/buildings.js";
import { useApp, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { MissingList } from "../widgets/missing_list.js";
import { copyTable } from "./building_actions.js";
import { BuildingCard } from "./building_card.js";
import { BuildingTable } from "./building_table.js";
import { fileLabel, type SortOrder, sortBuildings } from "./building_text.js";

export function BuildingsPanel(): ReactElement {
  const { project } = useApp();
  const { set, loading, error } = useStore((state) => state.buildings);
  if (project.buildings === null) {
    return <MissingList missing={project.missing.filter(({ what }) => what === "buildings")} />;
  }
  if (set === null) {
    const text = loading ? "The buildings are being loaded …" : `The buildings could not be loaded: ${error}`;
    return <p role="status">{text}</p>;
  }
  if (set.buildings.length === 0) return <p className="hint">No building was found in this survey.</p>;
  return <Buildings set={set} files={project.buildings.files} />;
}

function Buildings({ set, files }: { readonly set: BuildingSet; readonly files: readonly string[] }): ReactElement {
  const context = useApp();
  const { store } = context;
  const shown = useStore((state) => state.layers.buildings);
  const selected = useStore((state) => state.selectedBuilding);
  const [order, setOrder] = useState<SortOrder>({ key: "id", descending: false });
  const buildings = useMemo(() => sortBuildings(set.buildings, order), [set, order]);
  const doubtful = set.buildings.filter(({ accepted }) => !accepted).length;
  const chosen = findBuilding(set, selected);
  const at = chosen === null ? -1 : buildings.indexOf(chosen);
  return (
    <div className={chosen === null ? "building-panel" : "building-panel with-card"}>
      <p className="building-summary">
        {set.buildings.length.toLocaleString("en")} found{set.metric ? ", lengths in metres" : ", lengths without unit"}
        {doubtful === 0 ? null : (
          <>
            {"; "}
            <span className="doubtful-key" aria-hidden="true" /> {doubtful.toLocaleString("en")} to check
          </>
        )}
      </p>
      {shown ? null : (
        <button
          type="button"
          className="wide"
          onClick={() => store.update(({ layers }) => ({ layers: { ...layers, buildings: true } }))}
        >
          Show them in the view
        </button>
      )}
      <BuildingTable buildings={buildings} order={order} metric={set.metric} onOrder={setOrder} />
      {chosen === null ? (
        <p className="hint building-hint">Click a building in the view or in the table to see its measures.</p>
      ) : (
        <BuildingCard
          building={chosen}
          set={set}
          previous={buildings[at - 1] ?? null}
          next={buildings[at + 1] ?? null}
        />
      )}
      <section className="building-files">
        <h3>All buildings</h3>
        <div className="buttons">
          <button type="button" onClick={() => void copyTable(context, buildings)}>
            <Icon name="copy" size={16} /> Copy as CSV
          </button>
          {files.map((url) => (
            <a key={url} className="button-like" href={url} download>
              {fileLabel(url)}
            </a>
          ))}
        </div>
      </section>
    </div>
  );
}
