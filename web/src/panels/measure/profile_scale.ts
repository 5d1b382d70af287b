// The geometry of the profile's chart, pure.

export interface ChartProfile {
  readonly lengthM: number;
  readonly heightsM: readonly (number | null)[];
  readonly spreadsM: readonly (number | null)[];
}
interface Frame {
  readonly w: number;
  readonly h: number;
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}
export interface ChartScale {
  readonly lowM: number;
  readonly highM: number;
  /** Of the labels of heights. */
  readonly decimals: number;
  x(distanceM: number): number;
  y(heightM: number): number;
  /** Of a sample. */
  xOf(index: number): number;
  indexAt(x: number): number;
}

/** A flat profile must not become a mountain range of noise. */
const LEAST_RANGE_M = 0.2;

/** Null: no sample has a height. */
export function chartScale({ lengthM, heightsM }: ChartProfile, offsetM: number, frame: Frame): ChartScale | null {
  let low = Number.POSITIVE_INFINITY;
  let high = Number.NEGATIVE_INFINITY;
  for (const height of heightsM) {
    if (height === null) continue;
    low = Math.min(low, height + offsetM);
    high = Math.max(high, height + offsetM);
  }
  if (!(low <= high)) return null;
  const margin = Math.max((high - low) * 0.06, (LEAST_RANGE_M - (high - low)) / 2);
  const [lowM, highM] = [low - margin, high + margin];
  const wide = frame.w - frame.left - frame.right;
  const tall = frame.h - frame.top - frame.bottom;
  const last = Math.max(1, heightsM.length - 1);
  const length = lengthM > 0 ? lengthM : 1;
  return {
    lowM,
    highM,
    decimals: Math.max(0, Math.min(3, -Math.floor(Math.log10((highM - lowM) / 4)))),
    x: (distanceM) => frame.left + (distanceM / length) * wide,
    y: (heightM) => frame.top + ((highM - heightM) / (highM - lowM)) * tall,
    xOf: (index) => frame.left + (index / last) * wide,
    indexAt: (x) => ((x - frame.left) / wide) * last,
  };
}

/** Round values between low and high, about `count` of them. */
export function ticks(low: number, high: number, count: number): readonly number[] {
  const range = high - low;
  if (!(range > 0) || !Number.isFinite(range)) return [];
  const power = 10 ** Math.floor(Math.log10(range / count));
  const step = ([1, 2, 5, 10].find((factor) => range / (factor * power) <= count + 1e-9) ?? 10) * power;
  const values: number[] = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1) {
    // Without the tail of binary fractions: 0.30000000000000004.
    values.push(Number((i * step).toPrecision(12)));
  }
  return values;
}

/** Runs of samples that have a height. */
function runs(
  heightsM: readonly (number | null)[],
): readonly (readonly { readonly i: number; readonly height: number }[])[] {
  const all: { i: number; height: number }[][] = [];
  let open: { i: number; height: number }[] | null = null;
  heightsM.forEach((height, i) => {
    if (height === null) {
      open = null;
      return;
    }
    if (open === null) {
      open = [];
      all.push(open);
    }
    open.push({ i, height });
  });
  return all;
}

function point(x: number, y: number): string {
  return `${x.toFixed(2)} ${y.toFixed(2)}`;
}

/** One path per run, so that gaps stay gaps. */
export function linePaths(heightsM: readonly (number | null)[], offsetM: number, scale: ChartScale): readonly string[] {
  return runs(heightsM).map((run) => {
    const places = run.map(({ i, height }) => point(scale.xOf(i), scale.y(height + offsetM)));
    // A single sample would be no line.
    return `M${places.join("L")}${places.length === 1 ? "h0.01" : ""}`;
  });
}

/** Bands of one standard deviation up and down. */
export function spreadPaths(
  heightsM: readonly (number | null)[],
  spreadsM: readonly (number | null)[],
  offsetM: number,
  scale: ChartScale,
): readonly string[] {
  const known = heightsM.map((height, i) => ((spreadsM[i] ?? null) === null ? null : height));
  return runs(known)
    .filter((run) => run.length > 1)
    .map((run) => {
      const edge = (sign: number) =>
        run.map(({ i, height }) => {
          const y = scale.y(height + offsetM + sign * (spreadsM[i] ?? 0));
          return point(scale.xOf(i), y);
        });
      return `M${edge(1).join("L")}L${edge(-1).reverse().join("L")}Z`;
    });
}
