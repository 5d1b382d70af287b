// A length on the screen in metres, true in the middle of the view.
import type { ReactElement } from "react";
import { niceScale } from "../../geo/format.js";
import { useStore } from "../use_store.js";

const LONGEST_PX = 120;
const LONGEST_ON_PHONES_PX = 50;

export function ScaleBar(): ReactElement | null {
  const metresPerPx = useStore((state) => state.readout.metresPerPx);
  const longestPx = window.innerWidth <= 720 ? LONGEST_ON_PHONES_PX : LONGEST_PX;
  const scale = metresPerPx === null ? null : niceScale(metresPerPx * longestPx);
  if (metresPerPx === null || scale === null) return null;
  return (
    <div className="scale-bar" title="In the middle of the view" role="img" aria-label={`Scale bar: ${scale.text}`}>
      <span>{scale.text}</span>
      <span className="scale-line" style={{ width: scale.lengthM / metresPerPx }} />
    </div>
  );
}
