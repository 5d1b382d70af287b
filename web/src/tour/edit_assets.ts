// Which uploaded files a tour lists: all that are used and no others. Undo brings a file's entry back with the tour that used it.
import { type Asset, type Tour, usedAssets } from "./types.js";

/** An uploaded file, as it is listed. */
export interface NamedAsset extends Asset {
  /** Name of the asset: SHA-256, a point, its type. */
  readonly file: string;
}

export function withAsset(tour: Tour, { file, name, bytes }: NamedAsset): Tour {
  const known = tour.assets.get(file);
  if (known !== undefined && known.name === name && known.bytes === bytes) return tour;
  return { ...tour, assets: new Map(tour.assets).set(file, { name, bytes }) };
}

export function withoutUnusedAssets(tour: Tour): Tour {
  const used = usedAssets(tour);
  const assets = [...tour.assets].filter(([file]) => used.has(file));
  return assets.length === tour.assets.size ? tour : { ...tour, assets: new Map(assets) };
}
