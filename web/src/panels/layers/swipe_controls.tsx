// The earlier project: switch and line between the two.
import type { ReactElement } from "react";
import { useApp, useStore } from "../use_store.js";

export function SwipeControls(): ReactElement | null {
  const { store, project } = useApp();
  const swipe = useStore((state) => state.swipe);
  if (project.before === null) return null;
  return (
    <section>
      <h3>Before and after</h3>
      <label className="layer-row">
        <input
          type="checkbox"
          className="switch"
          checked={swipe.on}
          onChange={(event) => store.set({ swipe: { ...swipe, on: event.currentTarget.checked } })}
        />
        <span className="layer-label">Swipe</span>
        <span className="layer-detail">{project.before.name}</span>
      </label>
      {swipe.on ? (
        <label className="field">
          <span className="sr-only">Line between before and after</span>
          <input
            type="range"
            min={0}
            max={100}
            value={Math.round(swipe.at * 100)}
            aria-valuetext={`${Math.round(swipe.at * 100)} % shows the earlier project`}
            onChange={(event) => store.set({ swipe: { ...swipe, at: Number(event.currentTarget.value) / 100 } })}
          />
        </label>
      ) : null}
    </section>
  );
}
