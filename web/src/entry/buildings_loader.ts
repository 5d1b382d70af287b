// Loads the buildings when they are first wanted: by their layer or by their panel, which shows the layer too.
import { errorText } from "../base/abort.js";
import type { BuildingSet } from "../state/buildings.js";
import { addNotice } from "../state/notices.js";
import type { Project } from "../state/project.js";
import type { Store } from "../state/store.js";

/** Returns the function that ends it. */
export function keepBuildings(store: Store, project: Project, load: (url: string) => Promise<BuildingSet>): () => void {
  const url = project.buildings?.url;
  if (url === undefined) return () => {};
  const fetchThem = async (): Promise<void> => {
    const { set, loading } = store.get().buildings;
    if (set !== null || loading) return;
    store.set({ buildings: { set: null, loading: true, error: "" } });
    try {
      store.set({ buildings: { set: await load(url), loading: false, error: "" } });
    } catch (error) {
      // Opening the panel or switching the layer on again tries again.
      const text = errorText(error);
      store.update(({ layers }) => ({
        buildings: { set: null, loading: false, error: text },
        layers: { ...layers, buildings: false },
      }));
      addNotice(store, "error", `The buildings cannot be shown: ${text}`);
    }
  };
  const ends = [
    store.subscribe(
      ({ panel }) => panel === "buildings",
      (open) => {
        if (open) store.update(({ layers }) => ({ layers: { ...layers, buildings: true } }));
      },
    ),
    store.subscribe(
      ({ layers }) => layers.buildings,
      (on) => {
        if (on) void fetchThem();
      },
    ),
  ];
  return () => {
    for (const end of ends) end();
  };
}
