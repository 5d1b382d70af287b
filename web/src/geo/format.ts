// Numbers as people read them. What is not a number becomes a dash, never "NaN".
import type { Vec2, Vec3 } from "../base/vec.js";
import type { Estimate } from "./measure.js";

export type UnitKind = "length" | "area" | "volume";

interface Unit {
  readonly name: string;
  /** Metres, square or cubic metres in one. */
  readonly size: number;
  readonly decimals: number;
}

const NOTHING = "–";

function unitFor(kind: UnitKind, value: number): Unit {
  const size = Math.abs(value);
  switch (kind) {
    case "length":
      if (size >= 99_999.95) return { name: "km", size: 1000, decimals: 1 };
      if (size >= 9999.95) return { name: "km", size: 1000, decimals: 3 };
      return { name: "m", size: 1, decimals: size >= 999.995 ? 1 : size >= 0.995 ? 2 : 3 };
    case "area":
      if (size >= 1e7) return { name: "km²", size: 1e6, decimals: 2 };
      if (size >= 1e5) return { name: "ha", size: 1e4, decimals: 2 };
      return { name: "m²", size: 1, decimals: size >= 999.95 ? 0 : size >= 9.995 ? 1 : 2 };
    case "volume":
      return { name: "m³", size: 1, decimals: size >= 999.95 ? 0 : size >= 9.995 ? 1 : 2 };
    default: {
      const never: never = kind;
      throw new Error(`unknown unit ${String(never)}`);
    }
  }
}

/** With the sign only where digits other than 0 follow. */
function fixed(value: number, decimals: number): string {
  const text = value.toFixed(decimals);
  return /^-0(\.0*)?$/.test(text) ? text.slice(1) : text;
}

function format(kind: UnitKind, value: number): string {
  if (!Number.isFinite(value)) return NOTHING;
  const unit = unitFor(kind, value);
  return `${fixed(value / unit.size, unit.decimals)} ${unit.name}`;
}

/** "12.34 m", "12.345 km". */
export function formatLength(m: number): string {
  return format("length", m);
}

/** "12.3 m²", "12.34 ha". */
export function formatArea(m2: number): string {
  return format("area", m2);
}

/** "12.3 m³". */
export function formatVolume(m3: number): string {
  return format("volume", m3);
}

/** One digit of sigma, two when it begins with 1: 0.05, 0.012. The exponent is that after rounding, so 0.0996 is 0.10. */
function decimalsOf(sigma: number): number {
  const [digits = "0", exponent = "0"] = sigma.toExponential(sigma.toExponential(1).startsWith("1") ? 1 : 0).split("e");
  return Math.max(0, (digits.startsWith("1") ? 1 : 0) - Number(exponent));
}

/** "12.34 m ± 0.05 m": digits that fit sigma, one standard deviation; without sigma the value alone. */
export function formatEstimate(estimate: Estimate, kind: UnitKind = "length"): string {
  const { value, sigma } = estimate;
  if (!Number.isFinite(value)) return NOTHING;
  if (sigma === null || !Number.isFinite(sigma) || sigma < 0) return format(kind, value);
  const unit = unitFor(kind, value);
  const finest = unit.size > 1 ? 6 : 3;
  const spread = sigma / unit.size;
  if (spread < 0.5 * 10 ** -finest) {
    return `${fixed(value / unit.size, finest)} ${unit.name} ± <${(10 ** -finest).toFixed(finest)} ${unit.name}`;
  }
  const decimals = Math.min(finest, decimalsOf(spread));
  return `${fixed(value / unit.size, decimals)} ${unit.name} ± ${fixed(spread, decimals)} ${unit.name}`;
}

/** "41.2° ± 0.5°", or "12.34 ± 0.05" of a length whose unit is unknown: as formatEstimate, with any suffix. */
export function formatWithSuffix({ value, sigma }: Estimate, suffix = ""): string {
  if (!Number.isFinite(value)) return NOTHING;
  if (sigma === null || !Number.isFinite(sigma) || sigma < 0) return `${fixed(value, 2)}${suffix}`;
  if (sigma < 0.0005) return `${fixed(value, 3)}${suffix} ± <0.001${suffix}`;
  const decimals = Math.min(3, decimalsOf(sigma));
  return `${fixed(value, decimals)}${suffix} ± ${fixed(sigma, decimals)}${suffix}`;
}

/** "47.3769000° N, 8.5417000° E": 7 decimals are a centimetre. */
export function formatLatLon(latitudeDeg: number, longitudeDeg: number): string {
  if (!Number.isFinite(latitudeDeg) || !Number.isFinite(longitudeDeg)) return NOTHING;
  const north = latitudeDeg < 0 ? "S" : "N";
  const east = longitudeDeg < 0 ? "W" : "E";
  return `${Math.abs(latitudeDeg).toFixed(7)}° ${north}, ${Math.abs(longitudeDeg).toFixed(7)}° ${east}`;
}

function dms(degrees: number): string {
  // In units of the last digit, so that 59.9999" carries.
  const hundredths = Math.round(Math.abs(degrees) * 360_000);
  const seconds = ((hundredths % 6000) / 100).toFixed(2).padStart(5, "0");
  const minutes = String(Math.floor(hundredths / 6000) % 60).padStart(2, "0");
  return `${Math.floor(hundredths / 360_000)}°${minutes}′${seconds}″`;
}

/** "47°22′36.84″ N, 8°32′30.12″ E". */
export function formatDms(latitudeDeg: number, longitudeDeg: number): string {
  if (!Number.isFinite(latitudeDeg) || !Number.isFinite(longitudeDeg)) return NOTHING;
  return `${dms(latitudeDeg)} ${latitudeDeg < 0 ? "S" : "N"}, ${dms(longitudeDeg)} ${longitudeDeg < 0 ? "W" : "E"}`;
}

/** Easting and northing: "465412.34 E, 5247012.30 N". */
export function formatMap(en: Vec2 | Vec3): string {
  if (!Number.isFinite(en[0]) || !Number.isFinite(en[1])) return NOTHING;
  return `${fixed(en[0], 2)} E, ${fixed(en[1], 2)} N`;
}

/** "heights above the WGS84 ellipsoid" becomes "WGS84 ellipsoid": the column says height already. */
export function shortVertical(vertical: string): string {
  return vertical.replace(/^\s*(ellipsoidal\s+)?heights?\s+(are\s+)?above\s+(the\s+)?/i, "").trim();
}

/** The longest 1, 2 or 5 times a power of ten that is at most maxM, with its text for the scale bar; null when there is no room. */
export function niceScale(maxM: number): { readonly lengthM: number; readonly text: string } | null {
  if (!(maxM > 0) || !Number.isFinite(maxM)) return null;
  let exponent = Math.floor(Math.log10(maxM));
  // The logarithm may be off by one rounding.
  if (10 ** exponent > maxM) exponent -= 1;
  if (10 ** (exponent + 1) <= maxM) exponent += 1;
  const step = ([5, 2, 1] as const).find((factor) => factor * 10 ** exponent <= maxM * (1 + 1e-12)) ?? 1;
  const lengthM = exponent < 0 ? step / 10 ** -exponent : step * 10 ** exponent;
  const text =
    exponent >= 3
      ? `${step * 10 ** (exponent - 3)} km`
      : exponent >= 0
        ? `${lengthM} m`
        : exponent >= -2
          ? `${step * 10 ** (exponent + 2)} cm`
          : `${exponent >= -3 ? step : step / 10 ** (-3 - exponent)} mm`;
  return { lengthM, text };
}
