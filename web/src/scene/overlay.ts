// Marks, lines and texts over the canvas as SVG, moved with the camera at each drawn frame. Colours are attributes, which a content security policy
// without inline styles allows.
import type { Vec2, Vec3 } from "../base/vec.js";
import type { AppState, CameraPose } from "../state/app_state.js";
import type { Project } from "../state/project.js";
import { clipLine } from "./overlay_clip.js";
import { type OverlayItem, type OverlayStyle, overlayInputs, overlayItems } from "./overlay_items.js";
import { svgElement } from "./svg.js";
import { cameraFromEnu, pixelOf, projectPoint, type Size } from "./view_math.js";

const COLOURS: Readonly<Record<OverlayStyle, string>> = {
  measure: "#ffd54a",
  selected: "#4ad8ff",
  draft: "#ffffff",
  control: "#ff6b6b",
  path: "#7ee787",
  block: "#9bd0ff",
  building: "#ffffff",
  photo: "#ff6bd6",
};
const HALO = "#10151b";
/** Beyond this some browsers draw nothing at all. */
const FARTHEST_PX = 30_000;

interface Drawn {
  readonly item: OverlayItem;
  readonly node: SVGElement;
}

function draw(item: OverlayItem): SVGElement {
  const colour = COLOURS[item.style];
  switch (item.kind) {
    case "line": {
      const group = svgElement("g", { class: `overlay-line overlay-${item.style}` });
      const common = { "stroke-linejoin": "round", "stroke-linecap": "round" };
      group.append(
        svgElement("path", { ...common, fill: "none", stroke: HALO, "stroke-width": 4, "stroke-opacity": 0.6 }),
        svgElement("path", {
          ...common,
          fill: item.closed ? colour : "none",
          "fill-opacity": 0.18,
          stroke: colour,
          "stroke-width": 2,
        }),
      );
      return group;
    }
    case "dot":
      return svgElement("circle", {
        class: `overlay-dot overlay-${item.style}`,
        r: 4,
        fill: colour,
        stroke: HALO,
        "stroke-width": 1.5,
      });
    case "cross": {
      const group = svgElement("g", { class: `overlay-cross overlay-${item.style}` });
      const d = "M-8 0H-2M2 0H8M0 -8V-2M0 2V8";
      group.append(svgElement("path", { d, stroke: HALO, "stroke-width": 4, fill: "none", "stroke-opacity": 0.7 }));
      group.append(svgElement("path", { d, stroke: colour, "stroke-width": 2, fill: "none" }));
      return group;
    }
    case "label": {
      const text = svgElement("text", {
        class: `overlay-label overlay-${item.style}`,
        fill: colour,
        stroke: HALO,
        "stroke-width": 3,
        "stroke-linejoin": "round",
        "paint-order": "stroke",
        "font-size": 12,
        "font-family": "system-ui, sans-serif",
        "font-weight": 600,
        "text-anchor": "middle",
      });
      text.textContent = item.text;
      return text;
    }
    default: {
      const never: never = item;
      throw new Error(`unknown item ${String(never)}`);
    }
  }
}

function pathOf(parts: readonly (readonly Vec2[])[], closed: boolean): string {
  const clamp = (value: number) => Math.min(FARTHEST_PX, Math.max(-FARTHEST_PX, value)).toFixed(1);
  return parts
    .map((part) => `M${part.map((px) => `${clamp(px[0])} ${clamp(px[1])}`).join("L")}${closed ? "Z" : ""}`)
    .join("");
}

export class Overlay {
  readonly root: SVGSVGElement;
  private readonly project: Project;
  private readonly sizeM: number;
  private inputs: readonly unknown[] = [];
  private drawn: Drawn[] = [];

  constructor(container: HTMLElement, project: Project, sizeM: number) {
    this.project = project;
    this.sizeM = sizeM;
    this.root = svgElement("svg", { class: "scene-overlay", "aria-hidden": "true", width: "100%", height: "100%" });
    const { style } = this.root;
    style.position = "absolute";
    style.left = "0";
    style.top = "0";
    style.width = "100%";
    style.height = "100%";
    style.pointerEvents = "none";
    style.overflow = "hidden";
    container.append(this.root);
  }

  /** Does the state ask for other marks than are drawn? */
  needs(state: AppState): boolean {
    const inputs = overlayInputs(state);
    return inputs.some((input, i) => !Object.is(input, this.inputs[i])) || this.inputs.length === 0;
  }

  update(state: AppState, pose: CameraPose, size: Size): void {
    if (this.needs(state)) {
      this.inputs = overlayInputs(state);
      this.drawn = overlayItems(this.project, state, this.sizeM).map((item) => ({ item, node: draw(item) }));
      this.root.replaceChildren(...this.drawn.map(({ node }) => node));
    }
    const near = Math.max(0.05, this.sizeM * 1e-4);
    for (const { item, node } of this.drawn) place(item, node, pose, size, near);
  }

  dispose(): void {
    this.root.remove();
    this.drawn = [];
  }
}

function place(item: OverlayItem, node: SVGElement, pose: CameraPose, size: Size, near: number): void {
  if (item.kind === "line") {
    const inCamera: Vec3[] = item.points.map((point) => cameraFromEnu(pose, point));
    const parts = clipLine(inCamera, item.closed, near).map((part) => part.map((point) => pixelOf(pose, size, point)));
    const d = pathOf(parts, item.closed);
    for (const path of node.children) path.setAttribute("d", d);
    return;
  }
  const px = projectPoint(pose, size, item.point);
  const inside = px !== null && px[0] > -200 && px[1] > -50 && px[0] < size[0] + 200 && px[1] < size[1] + 50;
  node.setAttribute("visibility", inside ? "visible" : "hidden");
  if (!inside) return;
  // Texts stand above what they name.
  const dy = item.kind === "label" ? -10 : 0;
  node.setAttribute("transform", `translate(${px[0].toFixed(1)} ${(px[1] + dy).toFixed(1)})`);
}
