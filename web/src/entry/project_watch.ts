// Notices that the project's files have changed: the engine's revision grows, then project.json has a new revision too.
import type { Project } from "../state/project.js";
import type { Store } from "../state/store.js";

const TRIES = 5;
const PAUSE_MS = 2000;

/** Calls `onChange` once. Returns the function that ends the watch. */
export function watchProject(
  store: Store,
  project: Project,
  load: () => Promise<Project>,
  onChange: () => void,
): () => void {
  // The first revision that is heard of belongs to the project as it was loaded.
  let known: number | null = store.get().engine.connected ? store.get().engine.revision : null;
  let ended = false;
  let looking = false;
  const end = (): void => {
    ended = true;
    unsubscribe();
  };
  const look = async (): Promise<void> => {
    if (looking) return;
    looking = true;
    // The files may be read again a moment after the engine has told of them.
    for (let attempt = 0; attempt < TRIES && !ended; attempt++) {
      const now = await load().catch(() => null);
      if (now !== null && now.revision !== project.revision && !ended) {
        end();
        onChange();
        return;
      }
      await new Promise((resolve) => setTimeout(resolve, PAUSE_MS));
    }
    looking = false;
  };
  const unsubscribe = store.subscribe(
    (state) => (state.engine.connected ? state.engine.revision : null),
    (revision) => {
      if (revision === null) return;
      if (known !== null && revision !== known) void look();
      known = revision;
    },
  );
  return end;
}
