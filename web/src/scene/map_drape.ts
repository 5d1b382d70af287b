// The map of errors that is on, as a texture that is laid over the surface from above.
import { type Texture, Vector2 } from "three";
import { errorText } from "../base/abort.js";
import type { DrapedMap } from "../state/app_state.js";
import { type Drape, textureOf } from "./surface_style.js";
import type { World } from "./world.js";

export interface DrapeEvents {
  changed(drape: Drape | null): void;
  failed(text: string): void;
}

export class MapDrape {
  private readonly world: World;
  private readonly events: DrapeEvents;
  private wanted: DrapedMap | null = null;
  private loaded: { readonly map: DrapedMap; readonly texture: Texture; readonly bitmap: ImageBitmap } | null = null;
  private abort: AbortController | null = null;

  constructor(world: World, events: DrapeEvents) {
    this.world = world;
    this.events = events;
  }

  get busy(): boolean {
    return this.abort !== null;
  }

  /** Null: no map is shown. */
  show(map: DrapedMap | null): void {
    if (map === this.wanted) return;
    this.wanted = map;
    this.abort?.abort();
    this.abort = null;
    if (map !== null && this.loaded?.map.url === map.url) {
      this.tell();
      return;
    }
    // Until another map is loaded, none is shown.
    this.events.changed(null);
    if (map !== null) void this.load(map);
  }

  dispose(): void {
    this.wanted = null;
    this.abort?.abort();
    this.abort = null;
    this.drop();
  }

  private async load(map: DrapedMap): Promise<void> {
    const abort = new AbortController();
    this.abort = abort;
    try {
      const response = await fetch(map.url, { signal: abort.signal, credentials: "same-origin" });
      if (!response.ok) throw new Error(`the server answers ${response.status}`);
      const bitmap = await createImageBitmap(await response.blob(), {
        colorSpaceConversion: "none",
        premultiplyAlpha: "none",
      });
      if (abort.signal.aborted) {
        bitmap.close();
        return;
      }
      this.drop();
      this.loaded = { map, texture: textureOf(bitmap), bitmap };
      this.abort = null;
      this.tell();
    } catch (error) {
      if (abort.signal.aborted) return;
      this.abort = null;
      this.events.failed(`The map of errors cannot be shown: ${errorText(error)}`);
    }
  }

  private tell(): void {
    const { loaded, world } = this;
    if (loaded === null) return;
    const corner = (at: DrapedMap["min"]) => new Vector2(at[0] - world.anchor[0], at[1] - world.anchor[1]);
    this.events.changed({ texture: loaded.texture, min: corner(loaded.map.min), max: corner(loaded.map.max) });
  }

  private drop(): void {
    this.loaded?.texture.dispose();
    this.loaded?.bitmap.close();
    this.loaded = null;
  }
}
