// Switches the held-out error on; the engine makes the map the first time.

import type { AppState } from "../../state/app_state.js";
import { addErrorNotice } from "../../state/notices.js";
import type { AppContext } from "../context.js";

/** Requests under way by store, so that a second switch does not ask again. */
const asking = new WeakSet<object>();

export async function showErrorMap(context: Pick<AppContext, "store" | "link">, on: boolean): Promise<void> {
  const { store, link } = context;
  setLayer(store.update.bind(store), on);
  if (!on || store.get().errorMap !== null || asking.has(store)) return;
  asking.add(store);
  try {
    store.set({ errorMap: await link.errorMap() });
  } catch (error) {
    setLayer(store.update.bind(store), false);
    addErrorNotice(store, "No map of the held-out error", error);
  } finally {
    asking.delete(store);
  }
}

function setLayer(
  update: (change: (state: AppState) => Partial<Omit<AppState, "documents">>) => void,
  on: boolean,
): void {
  update((state) => ({ layers: { ...state.layers, errorMap: on } }));
}
