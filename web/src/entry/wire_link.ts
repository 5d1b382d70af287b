// What the engine tells goes into the store.
import type { Link } from "../protocol/link_api.js";
import type { Store } from "../state/store.js";

/** Returns the function that ends it. `pass` and `passes` are the scene's: it knows what is drawn, also while the engine is away. */
export function wireLink(link: Link, store: Store): () => void {
  const endEngine = link.onEngine((status) => {
    store.update((state) => ({ engine: { ...state.engine, ...status } }));
  });
  const endProgress = link.onProgress((id, what, fraction, done) => {
    store.update((state) => {
      const busy = new Map(state.busy);
      if (done) busy.delete(id);
      else busy.set(id, { what, fraction });
      return { busy };
    });
  });
  return () => {
    endEngine();
    endProgress();
  };
}
