// Switches a layer on or off; the engine makes the map of a layer that shows one the first time.

import type { AppState, Layers } from "../../state/app_state.js";
import { isMapLayer, type MapLayer, withLayer } from "../../state/layers.js";
import { addErrorNotice } from "../../state/notices.js";
import type { AppContext } from "../context.js";

interface MapSource {
  readonly failed: string;
  ask(link: AppContext["link"]): Promise<Partial<Pick<AppState, MapLayer>>>;
}

const SOURCES: Readonly<Record<MapLayer, MapSource>> = {
  errorMap: {
    failed: "No map of the held-out error",
    ask: async (link) => ({ errorMap: await link.errorMap() }),
  },
  trust: {
    failed: "No map of the error to expect",
    ask: async (link) => ({ trust: await link.trustMap() }),
  },
};

type LayerContext = Pick<AppContext, "store" | "link">;

/** Requests under way by store, so that a second switch does not ask again. */
const asking = new WeakMap<object, Set<MapLayer>>();

export async function switchLayer(context: LayerContext, name: keyof Layers, on: boolean): Promise<void> {
  setLayer(context, name, on);
  if (on && isMapLayer(name)) await makeMap(context, name);
}

async function makeMap(context: LayerContext, name: MapLayer): Promise<void> {
  const { store, link } = context;
  const asked = asking.get(store) ?? new Set();
  if (store.get()[name] !== null || asked.has(name)) return;
  asking.set(store, asked.add(name));
  const { failed, ask } = SOURCES[name];
  try {
    store.set(await ask(link));
  } catch (error) {
    setLayer(context, name, false);
    addErrorNotice(store, failed, error);
  } finally {
    asked.delete(name);
  }
}

function setLayer({ store }: LayerContext, name: keyof Layers, on: boolean): void {
  store.update(({ layers }) => ({ layers: withLayer(layers, name, on) }));
}
