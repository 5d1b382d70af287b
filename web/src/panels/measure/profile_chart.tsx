// A height profile as a chart. The pointer or the arrow keys read single places.
import { type KeyboardEvent, type PointerEvent, type ReactElement, useState } from "react";
import { formatLength } from "../../geo/format.js";
import { type ChartProfile, chartScale, linePaths, spreadPaths, ticks } from "./profile_scale.js";

interface ProfileChartProps {
  readonly name: string;
  readonly profile: ChartProfile;
  /** Added to z of ENU for the heights shown. */
  readonly offsetM: number;
}

const W = 300;
const H = 170;
const FRAME = { left: 46, right: 8, top: 8, bottom: 34 };

export function ProfileChart({ name, profile, offsetM }: ProfileChartProps): ReactElement {
  const [at, setAt] = useState<number | null>(null);
  const { heightsM, spreadsM, lengthM } = profile;
  const scale = chartScale(profile, offsetM, { w: W, h: H, ...FRAME });
  if (scale === null) return <p className="hint">The profile meets no surface.</p>;
  const last = heightsM.length - 1;
  const show = (i: number): void => setAt(Math.min(last, Math.max(0, Math.round(i))));
  const onPointerMove = (event: PointerEvent<HTMLDivElement>): void => {
    const box = event.currentTarget.getBoundingClientRect();
    if (box.width > 0) show(scale.indexAt(((event.clientX - box.left) / box.width) * W));
  };
  const onKeyDown = (event: KeyboardEvent): void => {
    const step = event.shiftKey ? Math.ceil(last / 10) : 1;
    const from = at ?? 0;
    if (event.key === "ArrowRight" || event.key === "ArrowUp") show(from + step);
    else if (event.key === "ArrowLeft" || event.key === "ArrowDown") show(from - step);
    else if (event.key === "Home") show(0);
    else if (event.key === "End") show(last);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  const place = at === null ? null : readOut(at, profile, offsetM);
  const height = at === null ? null : (heightsM[at] ?? null);
  return (
    <figure className="profile-chart">
      <div
        className="profile-area"
        role="slider"
        tabIndex={0}
        aria-label={`Height profile ${name}`}
        aria-valuemin={0}
        aria-valuemax={last}
        aria-valuenow={at ?? 0}
        aria-valuetext={place ?? "Arrow keys read the profile"}
        onPointerMove={onPointerMove}
        onPointerDown={onPointerMove}
        onPointerLeave={() => setAt(null)}
        onKeyDown={onKeyDown}
      >
        <svg viewBox={`0 0 ${W} ${H}`} width="100%" aria-hidden="true" focusable="false">
          <g stroke="currentColor" strokeOpacity={0.18} strokeWidth={1}>
            {ticks(scale.lowM, scale.highM, 4).map((value) => (
              <line key={value} x1={FRAME.left} x2={W - FRAME.right} y1={scale.y(value)} y2={scale.y(value)} />
            ))}
          </g>
          <g fill="currentColor" fontSize={10} textAnchor="end">
            {ticks(scale.lowM, scale.highM, 4).map((value) => (
              <text key={value} x={FRAME.left - 5} y={scale.y(value) + 3.5}>
                {value.toFixed(scale.decimals)}
              </text>
            ))}
          </g>
          <g fill="currentColor" fontSize={10} textAnchor="middle">
            {ticks(0, lengthM, 6).map((value) => (
              <text key={value} x={scale.x(value)} y={H - FRAME.bottom + 13}>
                {Number(value.toPrecision(6))}
              </text>
            ))}
            <text x={(FRAME.left + W - FRAME.right) / 2} y={H - 5}>
              Distance (m)
            </text>
            <text
              x={11}
              y={(FRAME.top + H - FRAME.bottom) / 2}
              transform={`rotate(-90 11 ${(FRAME.top + H - FRAME.bottom) / 2})`}
            >
              Height (m)
            </text>
          </g>
          <g fill="currentColor" fillOpacity={0.18}>
            {spreadPaths(heightsM, spreadsM, offsetM, scale).map((d) => (
              <path key={d} d={d} />
            ))}
          </g>
          <g fill="none" stroke="currentColor" strokeWidth={1.6} strokeLinejoin="round">
            {linePaths(heightsM, offsetM, scale).map((d) => (
              <path key={d} d={d} />
            ))}
          </g>
          {at === null ? null : (
            <line
              x1={scale.xOf(at)}
              x2={scale.xOf(at)}
              y1={FRAME.top}
              y2={H - FRAME.bottom}
              stroke="currentColor"
              strokeDasharray="3 3"
            />
          )}
          {at === null || height === null ? null : (
            <circle cx={scale.xOf(at)} cy={scale.y(height + offsetM)} r={3.5} fill="currentColor" />
          )}
        </svg>
      </div>
      <figcaption className="hint">
        {place ?? `${formatLength(lengthM)}; the band is ± one standard deviation`}
      </figcaption>
    </figure>
  );
}

function readOut(i: number, { heightsM, spreadsM, lengthM }: ChartProfile, offsetM: number): string {
  const distance = formatLength((lengthM * i) / Math.max(1, heightsM.length - 1));
  const height = heightsM[i] ?? null;
  const spread = spreadsM[i] ?? null;
  if (height === null) return `${distance}: no surface`;
  return `${distance}: ${(height + offsetM).toFixed(2)} m${spread === null ? "" : ` ± ${formatLength(spread)}`}`;
}
