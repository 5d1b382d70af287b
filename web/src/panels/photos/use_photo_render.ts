// The field's render of a photo's camera, drawn to a canvas as its passes come.
import { type RefObject, useEffect, useRef, useState } from "react";
import type { PhotoCamera } from "../../state/project.js";
import { useApp, useStore } from "../use_store.js";

/** Larger renders are refused by the engine. */
const WIDEST_PX = 2048;
const NARROWEST_PX = 64;
const ZOOM_REST_MS = 400;

interface PhotoRender {
  readonly canvas: RefObject<HTMLCanvasElement | null>;
  /** Why or how far; empty when it is complete. */
  readonly status: string;
}

/** For one photo: a component that changes its photo needs a new key. Scales: CSS pixels per pixel of the photo, when the whole photo is shown and now; 0: not known yet. */
export function usePhotoRender(photo: number, camera: PhotoCamera, fitScale: number, scale: number): PhotoRender {
  const { link } = useApp();
  const ready = useStore((state) => state.engine.connected && state.engine.ready);
  const reason = useStore((state) => state.engine.reason);
  const canvas = useRef<HTMLCanvasElement>(null);
  /** Width of the finest picture so far. */
  const drawnPx = useRef(0);
  const [progress, setProgress] = useState({ pass: -1, passes: 3 });
  const [widthPx, setWidthPx] = useState(0);

  useEffect(() => {
    if (fitScale <= 0) return;
    // The whole photo needs only the window's pixels; whoever looks closer gets all that there are.
    const close = scale > 1.5 * fitScale;
    const pixels = close ? camera.width : Math.ceil(camera.width * fitScale * devicePixelRatio);
    const wanted = Math.max(NARROWEST_PX, Math.min(WIDEST_PX, camera.width, pixels));
    const timer = setTimeout(() => setWidthPx((old) => Math.max(old, wanted)), widthRest(close));
    return () => clearTimeout(timer);
  }, [camera, fitScale, scale]);

  useEffect(() => {
    if (widthPx === 0 || !ready) return;
    const seq = { value: -1 };
    const end = link.onFrame((frame) => {
      // Frames of the view itself are the scene's.
      if (!frame.isPhoto) return;
      const target = canvas.current;
      if (frame.seq === seq.value && target !== null) {
        // A coarse pass must not replace the finer picture of a smaller request.
        if (frame.width >= drawnPx.current) {
          target.width = frame.width;
          target.height = frame.height;
          target.getContext("2d")?.drawImage(frame.bitmap, 0, 0);
          drawnPx.current = frame.width;
        }
        setProgress({ pass: frame.pass, passes: frame.passes });
      }
      frame.bitmap.close();
    });
    setProgress({ pass: -1, passes: 3 });
    seq.value = link.viewPhoto(photo, widthPx);
    // What is under way is not stopped: the scene may have asked for its own view by now, which replaces it.
    return end;
  }, [link, photo, widthPx, ready]);

  if (!ready) return { canvas, status: reason === "" ? "the engine is not ready" : reason };
  const complete = progress.pass >= progress.passes - 1;
  return { canvas, status: complete ? "" : `pass ${progress.pass + 1} of ${progress.passes}` };
}

function widthRest(close: boolean): number {
  return close ? ZOOM_REST_MS : 0;
}
