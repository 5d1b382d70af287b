// The browser may take the graphics card away (a driver update, sleep, too many tabs) and give it back. three.js uploads its data again by itself.
import { Disposer } from "../base/disposer.js";
import { addNotice, removeNotice } from "../state/notices.js";
import type { Store } from "../state/store.js";
import type { RenderLoop } from "./render_loop.js";

const LOST = "The graphics card was reset. The view comes back by itself; if it does not, reload the page.";

/** Returns the function that ends it. `restored`: what was made from data that are gone must be made again. */
export function watchContext(
  canvas: HTMLCanvasElement,
  store: Store,
  loop: RenderLoop,
  restored: () => void,
): () => void {
  const disposer = new Disposer();
  let notice: number | null = null;
  const forget = () => {
    if (notice !== null) removeNotice(store, notice);
    notice = null;
  };
  const listen = (type: string, handler: (event: Event) => void): void => {
    canvas.addEventListener(type, handler);
    disposer.add(() => canvas.removeEventListener(type, handler));
  };
  listen("webglcontextlost", (event) => {
    // Without this it never comes back.
    event.preventDefault();
    loop.pause(true);
    notice ??= addNotice(store, "error", LOST);
  });
  listen("webglcontextrestored", () => {
    forget();
    restored();
    loop.pause(false);
  });
  return () => disposer.dispose();
}
