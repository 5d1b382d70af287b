// The colour ramp of error maps, the same as the server paints them with: viridis, here as text for gradients and chips.

/** Viridis at 0, 1/8, ..., 1 as sRGB. */
const STOPS: readonly (readonly [number, number, number])[] = [
  [68, 1, 84],
  [72, 40, 120],
  [62, 74, 137],
  [49, 104, 142],
  [38, 130, 142],
  [31, 158, 137],
  [74, 193, 109],
  [160, 218, 57],
  [253, 231, 37],
];

/** `u` from 0 to 1, clamped; NaN counts as 0. */
export function rampColour(u: number): string {
  const at = Math.min(1, Math.max(0, Number.isFinite(u) ? u : 0)) * (STOPS.length - 1);
  const low = STOPS[Math.floor(at)];
  const high = STOPS[Math.ceil(at)];
  if (low === undefined || high === undefined) return "rgb(0 0 0)";
  const part = at - Math.floor(at);
  const mixed = low.map((value, channel) => Math.round(value + part * ((high[channel] ?? value) - value)));
  return `rgb(${mixed.join(" ")})`;
}

export function rampGradient(): string {
  return `linear-gradient(to right, ${STOPS.map((_, i) => rampColour(i / (STOPS.length - 1))).join(", ")})`;
}

/** PSNR between 20 dB (worst colour) and 35 dB (best) to 0..1. */
export function psnrQuality(psnrDb: number): number {
  return Math.min(1, Math.max(0, (psnrDb - 20) / 15));
}
