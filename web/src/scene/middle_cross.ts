// A cross in the middle of the view for those who place points by the keyboard. The style sheet shows it while the canvas has the keyboard's focus.
import type { AppState } from "../state/app_state.js";
import type { Store } from "../state/store.js";
import { svgElement } from "./svg.js";

const ARMS = "M-10 0H-3M3 0H10M0 -10V-3M0 3V10";

/** Behind the canvas in the page, on top of it in the view. */
export class MiddleCross {
  private readonly root: SVGSVGElement;
  private readonly unsubscribe: () => void;

  constructor(container: HTMLElement, store: Store) {
    this.root = svgElement("svg", { class: "scene-cross", viewBox: "-12 -12 24 24", "aria-hidden": "true" });
    this.root.append(
      svgElement("path", { d: ARMS, fill: "none", stroke: "#10151b", "stroke-width": 4, "stroke-opacity": 0.7 }),
      svgElement("path", { d: ARMS, fill: "none", stroke: "#ffffff", "stroke-width": 2 }),
    );
    container.append(this.root);
    const drawing = ({ tool }: AppState) => tool !== "navigate";
    const show = (on: boolean) => this.root.classList.toggle("scene-cross-wanted", on);
    this.unsubscribe = store.subscribe(drawing, show);
    show(drawing(store.get()));
  }

  dispose(): void {
    this.unsubscribe();
    this.root.remove();
  }
}
