// window.__skyquilt: what tests ask instead of reading pixels. Only in builds for tests (SKYQUILT_TEST_HOOK).
import type { Vec2 } from "../base/vec.js";
import { norm, sub } from "../base/vec_math.js";
import { poseLookingAt } from "../geo/camera.js";
import type { AppContext } from "../panels/context.js";
import { openCompare } from "../panels/photos/open_compare.js";
import type { Link } from "../protocol/link_api.js";
import type { Ray } from "../scene/scene_api.js";
import type { SceneThing } from "../scene/thing.js";
import type { AppState, CameraPose, Enu, Layers, SurfacePoint } from "../state/app_state.js";
import { withLayer } from "../state/layers.js";
import { type SettledFrame, samePose, type ViewLog } from "./view_log.js";

export interface TestHook {
  /** The first picture is drawn and the engine connected. */
  ready(): boolean;
  /** Tiles loaded and drawn. */
  idle(): Promise<void>;
  state(): Omit<AppState, "busy"> & { readonly busy: readonly string[] };
  pose(): CameraPose;
  flyTo(pose: CameraPose): Promise<void>;
  /** A level camera. */
  lookAt(eye: Enu, target: Enu, fovyDeg: number): Promise<void>;
  /** Resolves when the last pass of the view where the camera is has been drawn, or of the photo that lies over it. */
  settle(): Promise<SettledFrame>;
  capturePixels(): Promise<{ readonly w: number; readonly h: number; readonly rgba: string }>;
  pickAt(px: Vec2): Promise<{ readonly mesh: SurfacePoint | null; readonly field: SurfacePoint | null }>;
  project(enu: Enu): Vec2 | null;
  rayAt(px: Vec2): Ray;
  /** What a tour would place. */
  setThings(list: readonly SceneThing[]): void;
  highlightThings(selected: string | null, hovered: string | null): void;
  /** Id of what is seen there. */
  thingAt(px: Vec2): string | null;
  /** The surface or a model. */
  placeAt(px: Vec2): SurfacePoint | null;
  /** Distances of the mesh from the eye, NaN: none. */
  meshDistances(places: readonly Vec2[]): number[];
  /** Labels and markers that nothing hides. */
  visibleTexts(): readonly string[];
  /** Markers that were chosen, in order. */
  chosenThings(): readonly string[];
  setLayer(name: keyof Layers, on: boolean): void;
  /** A command by its id. */
  run(id: string): Promise<void>;
  openPhoto(photo: number): Promise<void>;
  fps(): number;
  statistics(): ReturnType<Link["statistics"]> & { readonly frames: number; readonly views: number };
}

declare global {
  interface Window {
    __skyquilt?: TestHook;
  }
}

const SETTLE_LIMIT_MS = 180_000;
const LOOK_AGAIN_MS = 50;
/** Longer than the cross-fade from surface to exact frame. */
const FADE_MS = 300;

type HookContext = Pick<AppContext, "project" | "store" | "scene" | "link" | "commands">;

export function installTestHook(context: HookContext, log: ViewLog): void {
  const { project, store, scene, link, commands } = context;
  const settled = (): SettledFrame | null => {
    const { view, frame } = log;
    if (view === null || frame === null || frame.seq !== view.seq || frame.pass < frame.passes - 1) return null;
    const compare = store.get().compare;
    if (compare !== null) return view.photo === compare.photo ? frame : null;
    const { pass, passes } = store.get().engine;
    if (view.parameters === null || pass < passes - 1 || !samePose(view.parameters, scene.pose())) return null;
    return frame;
  };
  const settle = async (): Promise<SettledFrame> => {
    const end = performance.now() + SETTLE_LIMIT_MS;
    while (performance.now() < end) {
      const first = settled();
      if (first !== null) {
        await pause(FADE_MS);
        await scene.whenIdle();
        if (settled()?.seq === first.seq) return { seq: first.seq, pass: first.pass, w: first.w, h: first.h };
      }
      await pause(LOOK_AGAIN_MS);
    }
    const { engine, compare } = store.get();
    throw new Error(
      `the view did not settle: ${JSON.stringify({ view: log.view, frame: log.frame, pose: scene.pose(), engine, compare })}`,
    );
  };
  const fieldAt = async (px: Vec2): Promise<SurfacePoint | null> => {
    const ray = scene.rayAt(px);
    const picked = await link.pick(ray);
    if (!picked.hit) return null;
    const pixelM = ray.pixelWidthM > 0 ? ray.pixelWidthM : ray.pixelPitch * picked.depthM;
    return { enu: picked.point, direction: ray.direction, spreadM: picked.spreadM, pixelM, source: "field" };
  };
  const chosen: string[] = [];
  scene.onThingChosen((id) => chosen.push(id));
  let drawn = false;
  void scene.whenIdle().then(() => {
    drawn = true;
  });
  window.__skyquilt = {
    ready: () => drawn && store.get().engine.connected,
    idle: () => scene.whenIdle(),
    state: () => {
      const { busy, ...state } = store.get();
      return { ...state, busy: [...busy.values()].map(({ what }) => what) };
    },
    pose: () => scene.pose(),
    flyTo: (pose) => scene.flyTo(pose, 0),
    lookAt: (eyeEnu, target, fovyDeg) =>
      scene.flyTo({ eyeEnu, rotation: poseLookingAt(eyeEnu, target), fovyDeg, orthoHeightM: null }, 0),
    settle,
    capturePixels: async () => pixelsOf(await scene.capture()),
    pickAt: async (px) => ({ mesh: scene.pickSurface(px), field: await fieldAt(px) }),
    project: (enu) => scene.project(enu),
    rayAt: (px) => scene.rayAt(px),
    setThings: (list) => scene.setThings(list),
    highlightThings: (selected, hovered) => scene.highlightThings(selected, hovered),
    thingAt: (px) => scene.pickThing(px),
    placeAt: (px) => scene.pickPlace(px),
    meshDistances: (places) =>
      places.map((px) => {
        const point = scene.pickSurface(px);
        return point === null ? Number.NaN : norm(sub(point.enu, scene.rayAt(px).originEnu));
      }),
    visibleTexts: () => scene.visibleTexts(),
    chosenThings: () => chosen,
    setLayer: (name, on) => store.update(({ layers }) => ({ layers: withLayer(layers, name, on) })),
    run: (id) => commands.run(id),
    openPhoto: async (index) => {
      const photo = project.photos[index];
      if (photo === undefined) throw new Error(`there is no photo ${index}`);
      await openCompare(context, photo);
    },
    fps: () => store.get().readout.fps,
    statistics: () => ({ ...link.statistics(), frames: log.frames, views: log.views }),
  };
}

async function pixelsOf(png: Blob): Promise<{ w: number; h: number; rgba: string }> {
  const bitmap = await createImageBitmap(png, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const { width: w, height: h } = bitmap;
  const context = new OffscreenCanvas(w, h).getContext("2d", { willReadFrequently: true });
  if (context === null) throw new Error("no 2-D canvas");
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  const { data } = context.getImageData(0, 0, w, h);
  let text = "";
  // Arguments of one call are limited.
  for (let at = 0; at < data.length; at += 8192) text += String.fromCharCode(...data.subarray(at, at + 8192));
  return { w, h, rgba: btoa(text) };
}

function pause(ms: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}
