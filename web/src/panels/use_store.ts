// How panels reach the application: the context by React, the state by a subscription to one selected value. A page that only plays a tour gives less than
// the viewer (PlayProvider); then only what asks by usePlay() and useStore() can be shown.
import { createContext, useContext, useSyncExternalStore } from "react";
import type { AppState } from "../state/app_state.js";
import type { AppContext, PlayContext } from "./context.js";

const ReactAppContext = createContext<AppContext | null>(null);
const ReactPlayContext = createContext<PlayContext | null>(null);
export const WholeProvider = ReactAppContext.Provider;
export const PlayProvider = ReactPlayContext.Provider;

export function useApp(): AppContext {
  const context = useContext(ReactAppContext);
  if (context === null) throw new Error("useApp: there is no AppProvider above this component");
  return context;
}

export function usePlay(): PlayContext {
  const context = useContext(ReactPlayContext);
  if (context === null) throw new Error("usePlay: there is no PlayProvider above this component");
  return context;
}

/** The selected value; the component draws again only when it is another one (by Object.is), so `select` must not make new objects. */
export function useStore<T>(select: (state: AppState) => T): T {
  const { store } = usePlay();
  return useSyncExternalStore(store.subscribeAll, () => select(store.get()));
}
