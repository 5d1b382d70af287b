// Gives the application's context to all panels, and its part for playing to those that need no more.
import type { ReactElement, ReactNode } from "react";
import type { AppContext } from "./context.js";
import { PlayProvider, WholeProvider } from "./use_store.js";

interface AppProviderProps {
  readonly value: AppContext;
  readonly children: ReactNode;
}

export function AppProvider({ value, children }: AppProviderProps): ReactElement {
  return (
    <PlayProvider value={value}>
      <WholeProvider value={value}>{children}</WholeProvider>
    </PlayProvider>
  );
}
