// Requests that take longer, with how far they are.
import type { ReactElement } from "react";
import { useApp, useStore } from "../use_store.js";
import { IconButton } from "../widgets/icon_button.js";

export function BusyList(): ReactElement | null {
  const { link } = useApp();
  const busy = useStore((state) => state.busy);
  if (busy.size === 0) return null;
  return (
    <ul className="busy">
      {[...busy].map(([id, { what, fraction }]) => (
        <li key={id} className="busy-item card">
          <div className="busy-text">
            <span>{what}</span>
            {fraction === null ? (
              <progress aria-label={what} />
            ) : (
              <progress aria-label={what} max={1} value={fraction} />
            )}
          </div>
          <IconButton icon="close" label={`Cancel: ${what}`} side="left" onClick={() => link.cancel(id)} />
        </li>
      ))}
    </ul>
  );
}
