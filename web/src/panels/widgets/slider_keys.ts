// Keys of a slider from 0 to 1, as the WAI-ARIA practices name them.

/** The value that this key leads to; null: no key of a slider. */
export function stepOfKey(key: string, fast: boolean, value: number): number | null {
  const step = fast ? 0.1 : 0.01;
  const clamp = (next: number): number => Math.min(1, Math.max(0, next));
  switch (key) {
    case "ArrowLeft":
    case "ArrowDown":
      return clamp(value - step);
    case "ArrowRight":
    case "ArrowUp":
      return clamp(value + step);
    case "PageDown":
      return clamp(value - 0.1);
    case "PageUp":
      return clamp(value + 0.1);
    case "Home":
      return 0;
    case "End":
      return 1;
    default:
      return null;
  }
}
