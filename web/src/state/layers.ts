// Layers that exclude each other: the maps of errors lie over the same ground, so at most one of them is shown.
import type { AppState, DrapedMap, Layers } from "./app_state.js";

export const MAP_LAYERS = ["errorMap", "trust"] as const;
export type MapLayer = (typeof MAP_LAYERS)[number];

export function isMapLayer(name: keyof Layers): name is MapLayer {
  return MAP_LAYERS.some((map) => map === name);
}

/** The layers with this one on or off. A map that goes on takes the place of the other. */
export function withLayer(layers: Layers, name: keyof Layers, on: boolean): Layers {
  const others = on && isMapLayer(name) ? { errorMap: false, trust: false } : {};
  return { ...layers, ...others, [name]: on };
}

/** Null: no map is on, or it has not been made yet. */
export function shownMap(state: Pick<AppState, "layers" | MapLayer>): DrapedMap | null {
  const on = MAP_LAYERS.find((name) => state.layers[name]);
  return on === undefined ? null : state[on];
}
