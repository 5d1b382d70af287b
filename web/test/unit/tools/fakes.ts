// A canvas, a scene, an engine and a page for tests of the tools. The scene looks straight down from 100 m, one pixel is one metre.
import { ManualClock } from "../../../src/base/clock.js";
import { hashHex } from "../../../src/base/hash.js";
import type { Vec2 } from "../../../src/base/vec.js";
import { ChangedElsewhere, type LoadedDocument, type SaveOptions } from "../../../src/protocol/documents_client.js";
import type { Link, Picked, ProfileReply, VolumeReply } from "../../../src/protocol/link_api.js";
import type { Ray, SceneApi } from "../../../src/scene/scene_api.js";
import type { CameraPose, PhotoSight, SurfacePoint } from "../../../src/state/app_state.js";
import { CommandTable } from "../../../src/state/commands.js";
import { initialState, USUAL_RIGHTS } from "../../../src/state/initial.js";
import type { Project } from "../../../src/state/project.js";
import { Store } from "../../../src/state/store.js";
import type { Rights } from "../../../src/state/tour_state.js";
import type { DocumentFiles } from "../../../src/tools/documents_keeper.js";
import { sampleProject } from "../state/samples.js";

/** A promise that the test settles. */
export interface Question<Asked, Answer> {
  readonly asked: Asked;
  resolve(answer: Answer): void;
  reject(error: Error): void;
}

export class FakeEngine {
  readonly picks: Question<{ ray: Ray; project: string }, Picked>[] = [];
  readonly profiles: Question<{ from: Vec2; to: Vec2; samples: number; project: string }, ProfileReply>[] = [];
  readonly volumes: Question<
    { polygon: readonly Vec2[]; base: string; baseHeightM: number; project: string },
    VolumeReply
  >[] = [];
  readonly sights: Question<readonly number[], { checked: boolean; photos: readonly PhotoSight[] }>[] = [];

  link(): Link {
    const ask = <Asked, Answer>(list: Question<Asked, Answer>[], asked: Asked) =>
      new Promise<Answer>((resolve, reject) => list.push({ asked, resolve, reject }));
    const never = () => {
      throw new Error("not expected");
    };
    return {
      pick: (ray, project = "main") => ask(this.picks, { ray: { ...ray }, project }),
      profile: (from, to, samples, project = "main") => ask(this.profiles, { from, to, samples, project }),
      volume: (polygon, base, baseHeightM, project = "main") =>
        ask(this.volumes, { polygon, base, baseHeightM, project }),
      photosAt: (point) => ask(this.sights, point),
      view: never,
      viewPhoto: never,
      stop: never,
      onFrame: never,
      onEngine: never,
      onProgress: never,
      errorMap: never,
      trustMap: never,
      cancel: never,
      statistics: never,
      close: never,
    };
  }
}

export const NO_HIT: Picked = { hit: false, point: [0, 0, 0], depthM: 0, spreadM: null, opacity: 0 };

/** The field has its surface `up` metres above the mesh. */
export function hitAt(x: number, y: number, up = 0.5): Picked {
  return { hit: true, point: [x, y, up], depthM: 100 - up, spreadM: 0.05, opacity: 1 };
}

export class FakeCanvas extends EventTarget {
  clientWidth = 800;
  clientHeight = 600;
  getBoundingClientRect(): { left: number; top: number } {
    return { left: 10, top: 20 };
  }

  fire(type: string, px: Vec2, more: Record<string, unknown> = {}): void {
    const fields = {
      pointerId: 1,
      button: 0,
      buttons: 0,
      pointerType: "mouse",
      shiftKey: false,
      ctrlKey: false,
      metaKey: false,
    };
    this.dispatchEvent(Object.assign(new Event(type), fields, { clientX: px[0] + 10, clientY: px[1] + 20 }, more));
  }

  click(px: Vec2, more: Record<string, unknown> = {}): void {
    this.fire("pointerdown", px, { buttons: 1, ...more });
    this.fire("pointerup", px, more);
  }
}

export class FakePage extends EventTarget {
  readonly document = { visibilityState: "visible" };

  key(key: string, more: Record<string, unknown> = {}): Event {
    const fields = {
      key,
      shiftKey: false,
      ctrlKey: false,
      metaKey: false,
      altKey: false,
      repeat: false,
      isComposing: false,
    };
    const event = Object.assign(
      new Event("keydown", { cancelable: true }),
      fields,
      { getModifierState: () => false },
      more,
    );
    this.dispatchEvent(event);
    return event;
  }
}

export interface Bench {
  readonly project: Project;
  readonly store: Store;
  readonly commands: CommandTable;
  readonly clock: ManualClock;
  readonly canvas: FakeCanvas;
  readonly page: FakePage;
  readonly engine: FakeEngine;
  readonly scene: SceneApi;
  readonly link: Link;
  /** Building at each place of the canvas, by "x,y". */
  readonly buildings: Map<string, number>;
  /** Places of the canvas without a mesh. */
  readonly holes: Set<string>;
  picked: number;
  pose: CameraPose;
}

export function bench(change: Partial<Project> = {}, rights: Rights = USUAL_RIGHTS): Bench {
  const project = sampleProject({ georeferenced: false, crs: null, ...change });
  const store = new Store(initialState(project, rights));
  store.update(({ engine }) => ({ engine: { ...engine, connected: true, ready: true } }));
  const canvas = new FakeCanvas();
  const engine = new FakeEngine();
  const holes = new Set<string>();
  const buildings = new Map<string, number>();
  const rayAt = (px: Vec2): Ray => ({
    originEnu: [px[0], -px[1], 100],
    direction: [0, 0, -1],
    pixelPitch: 0.001,
    pixelWidthM: 0,
  });
  const made: Bench = {
    project,
    store,
    commands: new CommandTable(),
    clock: new ManualClock(),
    canvas,
    page: new FakePage(),
    engine,
    link: engine.link(),
    buildings,
    holes,
    picked: 0,
    pose: { eyeEnu: [0, 0, 100], rotation: [0, 1, 0, 0], fovyDeg: 50, orthoHeightM: null },
    scene: {
      // Only what is above is used of it.
      canvas: canvas as unknown as HTMLCanvasElement,
      pose: () => made.pose,
      flyTo: () => Promise.resolve(),
      frameBox: () => Promise.resolve(),
      rayAt,
      pickSurface: (px): SurfacePoint | null => {
        made.picked += 1;
        if (holes.has(`${px}`)) return null;
        return { enu: [px[0], -px[1], 0], direction: [0, 0, -1], spreadM: null, pixelM: 0.1, source: "mesh" };
      },
      pickBuilding: (px) => buildings.get(`${px}`) ?? null,
      setThings: () => {},
      highlightThings: () => {},
      onThingChosen: () => () => {},
      pickThing: () => null,
      pickPlace: () => null,
      boxOfThing: () => null,
      visibleTexts: () => [],
      project: (point) => [point[0], -point[1]],
      invalidate: () => {},
      whenIdle: () => Promise.resolve(),
      capture: () => Promise.reject(new Error("not expected")),
      dispose: () => {},
    },
  };
  return made;
}

/** Lets promises that are settled go on. */
export async function settle(): Promise<void> {
  for (let i = 0; i < 30; i += 1) await Promise.resolve();
}

/** Files in memory, as the server keeps them; `fail` makes saving fail. */
export class FakeFiles implements DocumentFiles {
  readonly texts = new Map<string, string>();
  readonly saves: string[] = [];
  fail = "";
  failLoad = "";
  /** Saving waits until this is called. */
  hold: Promise<void> | null = null;

  /** Saved, but the answer does not come back. */
  loseAnswer = false;

  async load(file: string): Promise<LoadedDocument> {
    if (this.failLoad !== "") throw new Error(this.failLoad);
    return { text: this.texts.get(file) ?? null, tag: this.tag(file) };
  }

  async save(file: string, text: string, { ifMatch, keepalive }: SaveOptions): Promise<string | null> {
    this.saves.push(keepalive === true ? `${file} keepalive` : file);
    if (this.hold !== null) await this.hold;
    if (this.fail !== "") throw new Error(this.fail);
    if (ifMatch !== null && !ifMatch.split(", ").includes(this.tag(file)))
      throw new ChangedElsewhere("changed in another window");
    this.texts.set(file, text);
    if (this.loseAnswer) throw new Error("the server does not answer");
    return this.tag(file);
  }

  private tag(file: string): string {
    // Of the body as of the file: nothing is written otherwise than it was sent.
    return `"${hashHex(new TextEncoder().encode(this.texts.get(file) ?? ""))}"`;
  }
}
