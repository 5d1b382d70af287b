// The one store of the application: get, set, subscribe to a selected value; silent when the value is equal. Documents are changed through
// `changeDocuments`, so that every change can be undone; nothing else can.
import type { AppState, Documents } from "./app_state.js";
import { History } from "./history.js";

export class Store {
  private state: AppState;
  private readonly listeners = new Set<() => void>();
  readonly history = new History<Documents>();

  constructor(initial: AppState) {
    this.state = initial;
  }

  get(): AppState {
    return this.state;
  }

  /** Replaces the given members. */
  set(patch: Partial<Omit<AppState, "documents">>): void {
    this.replace({ ...this.state, ...patch });
  }

  update(change: (state: AppState) => Partial<Omit<AppState, "documents">>): void {
    this.set(change(this.state));
  }

  /** One undoable step. Steps with the same `group` directly after each other become one (a drag, typing in one field). */
  changeDocuments(label: string, change: (documents: Documents) => Documents, group?: string): void {
    const before = this.state.documents;
    const after = change(before);
    if (after === before) return;
    this.history.push({ label, before, after, group: group ?? null });
    this.replace({ ...this.state, documents: after, save: "unsaved" });
  }

  /** No step of its own: the change is also made in all steps that can be undone or redone. It must leave alone what it is not about. */
  amendDocuments(change: (documents: Documents) => Documents): void {
    const before = this.state.documents;
    const after = change(before);
    this.history.amend((documents) => (documents === before ? after : change(documents)));
    if (after !== before) this.replace({ ...this.state, documents: after, save: "unsaved" });
  }

  /** Documents that came from the server: not undoable. */
  loadDocuments(documents: Documents): void {
    this.history.clear();
    this.replace({ ...this.state, documents });
  }

  undo(): string | null {
    const step = this.history.undo();
    if (step === null) return null;
    this.replace({ ...this.state, documents: step.before, save: "unsaved" });
    return step.label;
  }

  redo(): string | null {
    const step = this.history.redo();
    if (step === null) return null;
    this.replace({ ...this.state, documents: step.after, save: "unsaved" });
    return step.label;
  }

  /** Calls the listener when the selected value is another one (by Object.is). Returns the function that ends it. */
  subscribe<T>(select: (state: AppState) => T, listener: (value: T, state: AppState) => void): () => void {
    let last = select(this.state);
    const check = () => {
      const next = select(this.state);
      if (Object.is(last, next)) return;
      last = next;
      listener(next, this.state);
    };
    this.listeners.add(check);
    return () => this.listeners.delete(check);
  }

  /** For useSyncExternalStore. */
  readonly subscribeAll = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  private replace(next: AppState): void {
    this.state = next;
    for (const listener of [...this.listeners]) listener();
  }
}
