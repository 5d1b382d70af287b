// What has changed between two lists of things, by their ids. Of two with the same id the first counts.
export interface Changes<T> {
  readonly added: readonly T[];
  readonly removed: readonly T[];
  readonly changed: readonly { readonly before: T; readonly after: T }[];
}

export function byId<T extends { readonly id: string }>(list: readonly T[]): Map<string, T> {
  const known = new Map<string, T>();
  for (const thing of list) if (!known.has(thing.id)) known.set(thing.id, thing);
  return known;
}

/** Things that are the same object have not changed. */
export function changesBetween<T extends { readonly id: string }>(
  before: ReadonlyMap<string, T>,
  after: ReadonlyMap<string, T>,
): Changes<T> {
  const added: T[] = [];
  const changed: { before: T; after: T }[] = [];
  for (const [id, thing] of after) {
    const known = before.get(id);
    if (known === undefined) added.push(thing);
    else if (known !== thing) changed.push({ before: known, after: thing });
  }
  return { added, changed, removed: [...before.values()].filter(({ id }) => !after.has(id)) };
}
