// The address of a picture of the tour, which may first have to be made of bytes.
import { useEffect, useState } from "react";
import { usePlay } from "../use_store.js";

/** Null: not yet, or the picture is lost, which `lost` is told. */
export function useAssetUrl(asset: string | null, lost: () => void): string | null {
  const { assets } = usePlay();
  const [made, setMade] = useState<{ readonly asset: string; readonly url: string } | null>(null);
  const known = asset === null ? null : assets.url(asset);
  const direct = typeof known === "string" ? known : null;
  useEffect(() => {
    let left = false;
    if (asset === null || direct !== null) return;
    Promise.resolve(assets.url(asset)).then(
      (url) => {
        if (!left) setMade({ asset, url });
      },
      () => {
        if (!left) lost();
      },
    );
    return () => {
      left = true;
    };
  }, [assets, asset, direct, lost]);
  if (direct !== null) return direct;
  return made !== null && made.asset === asset ? made.url : null;
}
