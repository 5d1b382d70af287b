// How panels reach the application: the context by React, the state by a subscription to one selected value.
import { createContext, useContext, useSyncExternalStore } from "react";
import type { AppState } from "../state/app_state.js";
import type { AppContext } from "./context.js";

const ReactAppContext = createContext<AppContext | null>(null);
export const AppProvider = ReactAppContext.Provider;

export function useApp(): AppContext {
  const context = useContext(ReactAppContext);
  if (context === null) throw new Error("useApp: there is no AppProvider above this component");
  return context;
}

/** The selected value; the component draws again only when it is another one (by Object.is), so `select` must not make new objects. */
export function useStore<T>(select: (state: AppState) => T): T {
  const { store } = useApp();
  return useSyncExternalStore(store.subscribeAll, () => select(store.get()));
}
