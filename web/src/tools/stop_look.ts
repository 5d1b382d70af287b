// How the view looks at a stop: layers, brightness and measurements as its author wants them. At the end all is as it was before.
import type { Layers } from "../state/app_state.js";
import { withLayer } from "../state/layers.js";
import type { Store } from "../state/store.js";
import { LAYER_NAMES, type Stop } from "../tour/types.js";

export class StopLook {
  private readonly store: Store;
  private readonly before: {
    readonly layers: Layers;
    readonly exposureStops: number;
    readonly shownMeasurements: readonly string[] | null;
  };

  /** From here on the view belongs to the tour. */
  constructor(store: Store) {
    this.store = store;
    const { layers, exposureStops, shownMeasurements } = store.get();
    this.before = { layers, exposureStops, shownMeasurements };
  }

  apply(stop: Stop): void {
    const { store, before } = this;
    const own = stop.layers ?? {};
    // A stop that names the layer and no measurements means all of them.
    const all = stop.measurements.length === 0 && own.measurements === true;
    let layers: Layers = {
      ...before.layers,
      // The author's aids are not for visitors.
      cameraPath: false,
      things: true,
      measurements: all || stop.measurements.length > 0,
    };
    for (const name of LAYER_NAMES) {
      const on = own[name];
      if (on !== undefined) layers = withLayer(layers, name, on);
    }
    store.set({
      layers,
      exposureStops: stop.exposureStops ?? before.exposureStops,
      shownMeasurements: all ? null : stop.measurements,
    });
  }

  restore(): void {
    this.store.set(this.before);
  }
}
