// Lists that are never changed: each function returns the given list itself when nothing changes.

/** The entry at `from` comes to the place `to`. */
export function moved<T>(list: readonly T[], from: number, to: number): readonly T[] {
  const entry = list[from];
  if (entry === undefined || from === to || list[to] === undefined) return list;
  const others = list.filter((_, i) => i !== from);
  return [...others.slice(0, to), entry, ...others.slice(to)];
}

export function replaced<T>(list: readonly T[], change: (entry: T) => T): readonly T[] {
  const next = list.map(change);
  return next.every((entry, i) => entry === list[i]) ? list : next;
}

export function without<T>(list: readonly T[], goes: (entry: T) => boolean): readonly T[] {
  return list.some(goes) ? list.filter((entry) => !goes(entry)) : list;
}

/** `place` beyond the ends means the end. */
export function inserted<T>(list: readonly T[], entry: T, place: number): readonly T[] {
  const at = Math.min(list.length, Math.max(0, place));
  return [...list.slice(0, at), entry, ...list.slice(at)];
}
