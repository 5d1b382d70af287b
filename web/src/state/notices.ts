// Short messages to the user, for rooms that have no panels.
import { errorText, isAbort } from "../base/abort.js";
import type { Store } from "./store.js";

const MOST_NOTICES = 6;

export function addNotice(store: Store, kind: "info" | "error", text: string): void {
  store.update(({ notices }) => {
    // The same text twice says nothing new.
    const others = notices.filter((notice) => notice.text !== text);
    const id = notices.reduce((largest, notice) => Math.max(largest, notice.id), 0) + 1;
    return { notices: [...others, { id, kind, text }].slice(-MOST_NOTICES) };
  });
}

/** What was given up on purpose is no news. */
export function addErrorNotice(store: Store, what: string, error: unknown): void {
  if (!isAbort(error)) addNotice(store, "error", `${what}: ${errorText(error)}`);
}
