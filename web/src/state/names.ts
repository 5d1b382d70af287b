// Names that people give to measurements, key frames and control points.

export const LONGEST_NAME = 64;

// biome-ignore lint/suspicious/noControlCharactersInRegex: they are what must go
const CONTROLS = /[\u0000-\u001f\u007f]+/g;

/** Control characters as one space each run. */
export function withoutControls(text: string): string {
  return text.replace(CONTROLS, " ");
}

/** Without control characters and spaces at the ends, at most 64 characters; null: nothing is left. */
export function usableName(text: string): string | null {
  // By characters, so that none is cut in half.
  const name = [...withoutControls(text).trim()].slice(0, LONGEST_NAME).join("").trim();
  return name === "" ? null : name;
}

/** As the name of a file: without what file systems refuse, not hidden. May be empty. */
export function fileName(text: string): string {
  return withoutControls(text)
    .replace(/[\\/:*?"<>|]+/g, "-")
    .replace(/^[.\s]+/, "")
    .trim();
}

/** "Distance 1", or the first number that is free. */
export function freeName(prefix: string, taken: Iterable<string>): string {
  const names = new Set(taken);
  for (let number = 1; ; number += 1) {
    const name = `${prefix} ${number}`;
    if (!names.has(name)) return name;
  }
}

/** `name`, or with a number behind it when it is taken. */
export function uniqueName(name: string, taken: Iterable<string>): string {
  const names = new Set(taken);
  if (!names.has(name)) return name;
  for (let number = 2; ; number += 1) {
    const candidate = `${name} (${number})`;
    if (!names.has(candidate)) return candidate;
  }
}
