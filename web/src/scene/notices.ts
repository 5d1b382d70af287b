// Messages to the user from the scene.
import type { Store } from "../state/store.js";

const MOST_NOTICES = 6;

/** Returns its id. */
export function addNotice(store: Store, kind: "info" | "error", text: string): number {
  const { notices } = store.get();
  const id = notices.reduce((largest, notice) => Math.max(largest, notice.id), 0) + 1;
  store.set({
    notices: [...notices.filter((notice) => notice.text !== text), { id, kind, text }].slice(-MOST_NOTICES),
  });
  return id;
}

export function removeNotice(store: Store, id: number): void {
  store.update((state) => ({ notices: state.notices.filter((notice) => notice.id !== id) }));
}
