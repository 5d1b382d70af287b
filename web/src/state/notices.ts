// Short messages to the user, for rooms that have no panels.
import { errorText, isAbort } from "../base/abort.js";
import type { NoticeAction } from "./app_state.js";
import type { Store } from "./store.js";

const MOST_NOTICES = 6;

/** Returns its id. The same text twice says nothing new: the older one goes. */
export function addNotice(
  store: Store,
  kind: "info" | "error",
  text: string,
  actions: readonly NoticeAction[] = [],
): number {
  const { notices } = store.get();
  const id = notices.reduce((largest, notice) => Math.max(largest, notice.id), 0) + 1;
  const others = notices.filter((notice) => notice.text !== text);
  store.set({ notices: [...others, { id, kind, text, actions }].slice(-MOST_NOTICES) });
  return id;
}

export function removeNotice(store: Store, id: number): void {
  store.update((state) => ({ notices: state.notices.filter((notice) => notice.id !== id) }));
}

/** What was given up on purpose is no news. */
export function addErrorNotice(store: Store, what: string, error: unknown): void {
  if (!isAbort(error)) addNotice(store, "error", `${what}: ${errorText(error)}`);
}
