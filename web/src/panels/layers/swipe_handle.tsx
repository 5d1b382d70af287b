// The line between the earlier project (left) and this one, over the 3-D view.
import type { PointerEvent, ReactElement } from "react";
import { useApp, useStore } from "../use_store.js";
import { stepOfKey } from "../widgets/slider_keys.js";

export function SwipeHandle(): ReactElement | null {
  const { store, project, scene } = useApp();
  const swipe = useStore((state) => state.swipe);
  if (project.before === null || !swipe.on) return null;
  const move = (at: number): void => store.set({ swipe: { on: true, at: Math.min(1, Math.max(0, at)) } });
  const drag = (event: PointerEvent<HTMLDivElement>): void => {
    if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
    const box = scene.canvas.getBoundingClientRect();
    if (box.width > 0) move((event.clientX - box.left) / box.width);
  };
  return (
    <div className="swipe" style={{ left: `${swipe.at * 100}%` }}>
      <span className="swipe-name swipe-name-left">{project.before.name}</span>
      <span className="swipe-name swipe-name-right">{project.name}</span>
      <div
        className="swipe-grip"
        role="slider"
        tabIndex={0}
        aria-label="Line between before and after"
        aria-valuemin={0}
        aria-valuemax={100}
        aria-valuenow={Math.round(swipe.at * 100)}
        onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
        onPointerMove={drag}
        onKeyDown={(event) => {
          const next = stepOfKey(event.key, event.shiftKey, swipe.at);
          if (next === null) return;
          event.preventDefault();
          event.stopPropagation();
          move(next);
        }}
      />
    </div>
  );
}
