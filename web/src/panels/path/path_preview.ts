// Plays the camera path in the view: the same poses that the video will have.
import { type RefObject, useEffect, useRef, useState } from "react";
import type { CameraPath } from "../../state/app_state.js";
import { poseOnPath, sectionSeconds } from "../../state/camera_path.js";
import type { AppContext } from "../context.js";

export interface PathPreview {
  readonly playing: boolean;
  /** 0 to 1, of the whole path. */
  readonly fraction: number;
  readonly start: () => void;
  readonly stop: () => void;
}

const SHOWN_MS = 100;

export function usePathPreview({ scene, store }: AppContext, path: CameraPath): PathPreview {
  const [playing, setPlaying] = useState(false);
  const [fraction, setFraction] = useState(0);
  // The path may be changed while it plays; the new one goes on.
  const newest: RefObject<CameraPath> = useRef(path);
  newest.current = path;
  useEffect(() => {
    if (!playing) return;
    let frame = 0;
    let sections = 0;
    let lastMs: number | null = null;
    let shownMs = Number.NEGATIVE_INFINITY;
    const draw = (nowMs: number): void => {
      const { keys } = newest.current;
      const seconds = sectionSeconds(newest.current);
      const end = keys.length - 1;
      // A page that was in the background must not jump ahead.
      const passedMs = Math.min(250, nowMs - (lastMs ?? nowMs));
      lastMs = nowMs;
      sections = seconds > 0 ? Math.min(end, sections + passedMs / 1000 / seconds) : end;
      const pose = poseOnPath(keys, sections);
      if (pose !== null) void scene.flyTo(pose, 0);
      if (nowMs - shownMs >= SHOWN_MS) {
        shownMs = nowMs;
        setFraction(end > 0 ? sections / end : 1);
      }
      if (pose === null || sections >= end) setPlaying(false);
      else frame = requestAnimationFrame(draw);
    };
    frame = requestAnimationFrame(draw);
    const stop = (): void => setPlaying(false);
    const key = (event: KeyboardEvent): void => {
      if (event.key !== "Escape") return;
      event.preventDefault();
      // It ends the preview and nothing else.
      event.stopPropagation();
      stop();
    };
    window.addEventListener("keydown", key, { capture: true });
    // Whoever takes the view into the hand wants to stay here.
    scene.canvas.addEventListener("pointerdown", stop);
    scene.canvas.addEventListener("wheel", stop, { passive: true });
    return () => {
      cancelAnimationFrame(frame);
      window.removeEventListener("keydown", key, { capture: true });
      scene.canvas.removeEventListener("pointerdown", stop);
      scene.canvas.removeEventListener("wheel", stop);
    };
  }, [playing, scene]);
  const start = (): void => {
    // From straight above there is no perspective.
    if (store.get().navigation === "top") store.set({ navigation: "map" });
    setFraction(0);
    setPlaying(true);
  };
  return { playing, fraction, start, stop: () => setPlaying(false) };
}
