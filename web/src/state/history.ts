// Undo and redo as a list of steps and a cursor.

export interface Step<T> {
  readonly label: string;
  readonly before: T;
  readonly after: T;
  readonly group: string | null;
}

const LIMIT = 200;

export class History<T> {
  private steps: Step<T>[] = [];
  /** Number of steps that are done; those from here on can be redone. */
  private cursor = 0;

  push(step: Step<T>): void {
    const last = this.cursor === this.steps.length ? this.steps[this.cursor - 1] : undefined;
    if (last !== undefined && step.group !== null && last.group === step.group) {
      this.steps[this.cursor - 1] = { ...step, before: last.before };
      return;
    }
    this.steps = [...this.steps.slice(0, this.cursor), step].slice(-LIMIT);
    this.cursor = this.steps.length;
  }

  undo(): Step<T> | null {
    const step = this.steps[this.cursor - 1];
    if (step === undefined) return null;
    this.cursor -= 1;
    // The step before must not swallow what comes next.
    this.closeGroup();
    return step;
  }

  redo(): Step<T> | null {
    const step = this.steps[this.cursor];
    if (step === undefined) return null;
    this.cursor += 1;
    return step;
  }

  /** The next step starts a new entry, whatever its group. */
  closeGroup(): void {
    const last = this.steps[this.cursor - 1];
    if (last !== undefined) this.steps[this.cursor - 1] = { ...last, group: null };
  }

  /** Changes the values of all steps: what came later but belongs to them (a better point), so that it takes no step of its own. */
  amend(change: (value: T) => T): void {
    // A value that two steps share stays shared.
    const known = new Map<T, T>();
    const changed = (value: T): T => {
      const found = known.get(value);
      if (found !== undefined) return found;
      const made = change(value);
      known.set(value, made);
      return made;
    };
    this.steps = this.steps.map((step) => ({ ...step, before: changed(step.before), after: changed(step.after) }));
  }

  clear(): void {
    this.steps = [];
    this.cursor = 0;
  }

  get undoLabel(): string | null {
    return this.steps[this.cursor - 1]?.label ?? null;
  }

  get redoLabel(): string | null {
    return this.steps[this.cursor]?.label ?? null;
  }
}
