// One event with typed arguments. A listener that throws does not keep the others from hearing.

export class Emitter<Args extends readonly unknown[]> {
  private readonly listeners = new Set<(...args: Args) => void>();

  /** Returns the function that ends it. */
  on(listener: (...args: Args) => void): () => void {
    // Wrapped, so that one function registered twice is called twice and ends once.
    const own = (...args: Args) => listener(...args);
    this.listeners.add(own);
    return () => this.listeners.delete(own);
  }

  /** Calls those that listen now; the first error is thrown after all were called. */
  emit(...args: Args): void {
    const errors: unknown[] = [];
    for (const listener of [...this.listeners]) {
      // One that an earlier listener ended must not hear this any more.
      if (!this.listeners.has(listener)) continue;
      try {
        listener(...args);
      } catch (error) {
        errors.push(error);
      }
    }
    if (errors.length > 0) throw errors[0];
  }

  get size(): number {
    return this.listeners.size;
  }

  clear(): void {
    this.listeners.clear();
  }
}
