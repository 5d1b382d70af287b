// Which places are hidden, found a few at a time, so that many of them do not hold up the picture. Pure; time is what the caller says.
export class SightQueue {
  private readonly hidden = new Map<string, boolean>();
  private waiting = new Set<string>();

  /** What is known may be wrong now; until it is found anew it still counts. */
  renew(ids: Iterable<string>): void {
    this.waiting = new Set(ids);
    for (const id of [...this.hidden.keys()]) if (!this.waiting.has(id)) this.hidden.delete(id);
  }

  /** Some are not found yet. */
  get busy(): boolean {
    return this.waiting.size > 0;
  }

  /** Finds one, and more until `over`. */
  step(isHidden: (id: string) => boolean, over: () => boolean): void {
    for (const id of [...this.waiting]) {
      this.hidden.set(id, isHidden(id));
      this.waiting.delete(id);
      if (over()) return;
    }
  }

  /** What nobody has looked for is not seen. */
  sees(id: string): boolean {
    return this.hidden.get(id) === false;
  }
}
