// What is drawn: layers, the earlier project, the clip box; and what the project lacks.
import type { ReactElement, ReactNode } from "react";
import type { AppState, Layers } from "../../state/app_state.js";
import type { MapLayer } from "../../state/layers.js";
import type { Project } from "../../state/project.js";
import { useApp, useStore } from "../use_store.js";
import { MissingList } from "../widgets/missing_list.js";
import { BlockList } from "./block_list.js";
import { ClipControls } from "./clip_controls.js";
import { MapLegend } from "./map_legend.js";
import { SwipeControls } from "./swipe_controls.js";
import { switchLayer } from "./switch_layer.js";

type LayerName = keyof Layers;

interface LayerText {
  readonly label: string;
  readonly detail: string;
  readonly available: boolean;
}

export function LayersPanel(): ReactElement {
  const { project } = useApp();
  return (
    <>
      <section>
        <LayerRow name="surface" />
        <LayerRow name="exact" />
        <LayerRow name="points" />
        <LayerRow name="contours" />
        <LayerRow name="buildings" />
        <LayerRow name="errorMap">
          <MapLegend name="errorMap" />
        </LayerRow>
        <LayerRow name="trust">
          <MapLegend name="trust" />
        </LayerRow>
      </section>
      <section>
        <LayerRow name="blocks">
          <BlockList blocks={project.blocks} />
        </LayerRow>
        <LayerRow name="cameras" />
        <LayerRow name="measurements" />
        <LayerRow name="controlPoints" />
        <LayerRow name="cameraPath" />
        <LayerRow name="things" />
      </section>
      <SwipeControls />
      <ClipControls />
      <MissingList missing={project.missing} />
    </>
  );
}

function LayerRow({ name, children }: { readonly name: LayerName; readonly children?: ReactNode }): ReactElement {
  const context = useApp();
  const { store, project } = context;
  const on = useStore((state) => state.layers[name]);
  const detail = useStore((state) => layerText(name, project, state).detail);
  const { label, available } = layerText(name, project, store.get());
  return (
    <div className={available ? "layer" : "layer unavailable"}>
      <label className="layer-row">
        <input
          type="checkbox"
          className="switch"
          checked={on && available}
          disabled={!available}
          onChange={(event) => void switchLayer(context, name, event.currentTarget.checked)}
        />
        <span className="layer-label">{label}</span>
        <span className="layer-detail">{detail}</span>
      </label>
      {on && available ? children : null}
    </div>
  );
}

function layerText(name: LayerName, project: Project, state: AppState): LayerText {
  switch (name) {
    case "surface":
      return surfaceText(project);
    case "exact":
      if (project.scene === null) return { label: "Exact frames", detail: "no field", available: false };
      return { label: "Exact frames", detail: counted(project.scene.blocks, "block"), available: true };
    case "blocks":
      return { label: "Blocks", detail: counted(project.blocks.length, "block"), available: project.blocks.length > 0 };
    case "cameras":
      return {
        label: "Cameras",
        detail: counted(project.photos.length, "photo"),
        available: project.photos.length > 0,
      };
    case "points":
      return {
        label: "Sparse points",
        detail: project.points === null ? "none" : "",
        available: project.points !== null,
      };
    case "contours":
      return {
        label: "Contours",
        detail: project.contours === null ? "none" : "",
        available: project.contours !== null,
      };
    case "buildings":
      return buildingsText(project, state);
    case "errorMap":
      return errorMapText(project, state);
    case "trust":
      return trustText(project, state);
    case "measurements":
      return { label: "Measurements", detail: String(state.documents.measurements.length), available: true };
    case "controlPoints":
      return { label: "Control points", detail: String(state.documents.controlPoints.length), available: true };
    case "cameraPath":
      return {
        label: "Camera path",
        detail: counted(state.documents.cameraPath.keys.length, "key frame"),
        available: true,
      };
    case "things":
      return { label: "Things of the tour", detail: String(state.documents.tour.things.length), available: true };
    default:
      return name satisfies never;
  }
}

function surfaceText(project: Project): LayerText {
  const label = "Surface";
  if (project.tiles !== null) {
    const triangles = project.surface?.triangles;
    return { label, detail: triangles === undefined ? "" : `${compact(triangles)} triangles`, available: true };
  }
  if (project.terrain !== null) return { label, detail: "orthophoto over heights", available: true };
  return { label, detail: "none", available: false };
}

function buildingsText(project: Project, state: AppState): LayerText {
  const label = "Buildings";
  const count = project.buildings?.count ?? 0;
  const detail = project.buildings === null ? "none" : count === 0 ? "none found" : counted(count, "building");
  return { label, detail: state.buildings.loading ? "being loaded …" : detail, available: count > 0 };
}

function errorMapText(project: Project, state: AppState): LayerText {
  const label = "Held-out error";
  if (project.scene === null) return { label, detail: "no field", available: false };
  const heldOut = project.photos.filter((photo) => photo.isTest).length;
  if (heldOut === 0) return { label, detail: "no held-out photos", available: false };
  return { label, detail: beingMade(state, "errorMap") ?? counted(heldOut, "photo"), available: true };
}

function trustText(project: Project, state: AppState): LayerText {
  const label = "Error to expect";
  if (project.scene === null) return { label, detail: "no field", available: false };
  if (!project.scene.trust) return { label, detail: "not measured", available: false };
  return { label, detail: beingMade(state, "trust") ?? "", available: true };
}

function beingMade(state: AppState, name: MapLayer): string | null {
  return state.layers[name] && state[name] === null ? "being made …" : null;
}

function counted(count: number, noun: string): string {
  return `${count.toLocaleString("en")} ${noun}${count === 1 ? "" : "s"}`;
}

function compact(count: number): string {
  if (count >= 1e6) return `${(count / 1e6).toFixed(1)} million`;
  return Math.round(count).toLocaleString("en");
}
