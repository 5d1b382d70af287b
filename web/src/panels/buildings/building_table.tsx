// All buildings as a table that its heads sort. The arrow keys go from row to row.
import { type KeyboardEvent, type ReactElement, useEffect, useRef, useState } from "react";
import type { Building } from "../../state/buildings.js";
import { useApp, useStore } from "../use_store.js";
import { columnText, nextOrder, ROOF_LABELS, SORT_KEYS, type SortKey, type SortOrder } from "./building_text.js";

const PAGE = 300;

const HEADS: Readonly<Record<SortKey, readonly [text: string, title: string]>> = {
  id: ["No.", "Number"],
  height: ["Height", "Height above the ground"],
  length: ["Length", "Length between the outer walls"],
  width: ["Width", "Width between the outer walls"],
  area: ["Area", "Area of the footprint"],
  roof: ["Roof", "Kind of roof"],
  accepted: ["Fits", "Whether the model describes the points of the roof"],
};

interface BuildingTableProps {
  /** In their order. */
  readonly buildings: readonly Building[];
  readonly order: SortOrder;
  readonly metric: boolean;
  readonly onOrder: (order: SortOrder) => void;
}

export function BuildingTable({ buildings, order, metric, onOrder }: BuildingTableProps): ReactElement {
  const { store } = useApp();
  const selected = useStore((state) => state.selectedBuilding);
  const [shown, setShown] = useState(PAGE);
  const box = useRef<HTMLDivElement>(null);
  const at = buildings.findIndex(({ id }) => id === selected);
  // One that was chosen in the view may be further down.
  const rows = buildings.slice(0, Math.max(shown, at + 1));
  const buttonOf = (id: number): HTMLButtonElement | null =>
    box.current?.querySelector<HTMLButtonElement>(`[data-building="${id}"]`) ?? null;

  // biome-ignore lint/correctness/useExhaustiveDependencies: `order` moves the row
  useEffect(() => {
    const row = selected === null ? null : buttonOf(selected)?.closest("tr");
    if (row !== null && row !== undefined && box.current !== null) showRow(box.current, row);
  }, [selected, order]);

  const onKey = (event: KeyboardEvent, i: number): void => {
    const step = { ArrowDown: i + 1, ArrowUp: i - 1, Home: 0, End: rows.length - 1 }[event.key];
    const next = step === undefined ? undefined : rows[step];
    if (next === undefined) return;
    event.preventDefault();
    store.set({ selectedBuilding: next.id });
    buttonOf(next.id)?.focus();
  };

  return (
    <div className="building-box" ref={box}>
      <table className="numbers buildings">
        <caption className="sr-only">
          Buildings. {metric ? "Lengths in metres, areas in square metres." : "Lengths and areas without unit."}
        </caption>
        <thead>
          <tr>
            {SORT_KEYS.map((key) => (
              <SortHead key={key} column={key} order={order} onOrder={onOrder} />
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((building, i) => (
            <tr key={building.id} className={building.id === selected ? "chosen" : undefined}>
              <th scope="row">
                <button
                  type="button"
                  className="link row-button"
                  data-building={building.id}
                  aria-label={`Building ${building.id}`}
                  aria-pressed={building.id === selected}
                  tabIndex={i === Math.max(at, 0) ? 0 : -1}
                  onClick={() => store.set({ selectedBuilding: building.id === selected ? null : building.id })}
                  onKeyDown={(event) => onKey(event, i)}
                  onPointerEnter={() => store.set({ hoverBuilding: building.id })}
                  onPointerLeave={() => store.set({ hoverBuilding: null })}
                >
                  {building.id}
                </button>
              </th>
              <td>{columnText(building, "height")}</td>
              <td>{columnText(building, "length")}</td>
              <td>{columnText(building, "width")}</td>
              <td>{columnText(building, "area")}</td>
              <td>{ROOF_LABELS[building.roof]}</td>
              <td className={building.accepted ? "fits" : "doubtful"}>{building.accepted ? "yes" : "no"}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {buildings.length > rows.length ? (
        <button type="button" className="wide" onClick={() => setShown(rows.length + PAGE)}>
          Show {Math.min(PAGE, buildings.length - rows.length)} more of {buildings.length}
        </button>
      ) : null}
    </div>
  );
}

/** Scrolls the table alone: the panel around it stays. */
function showRow(box: HTMLElement, row: HTMLElement): void {
  const head = box.querySelector("thead")?.clientHeight ?? 0;
  const above = row.offsetTop - head - box.scrollTop;
  const below = row.offsetTop + row.offsetHeight - box.clientHeight - box.scrollTop;
  if (above < 0) box.scrollTop += above;
  else if (below > 0) box.scrollTop += below;
}

interface SortHeadProps {
  readonly column: SortKey;
  readonly order: SortOrder;
  readonly onOrder: (order: SortOrder) => void;
}

function SortHead({ column, order, onOrder }: SortHeadProps): ReactElement {
  const [text, title] = HEADS[column];
  const sorted = order.key === column;
  const direction = order.descending ? "descending" : "ascending";
  return (
    <th scope="col" aria-sort={sorted ? direction : undefined}>
      <button type="button" className="link" title={title} onClick={() => onOrder(nextOrder(order, column))}>
        {text}
        <span className="sort-mark" aria-hidden="true">
          {sorted ? (order.descending ? "▾" : "▴") : ""}
        </span>
      </button>
    </th>
  );
}
