// What a stop says: its title at once, the rest when it is reached. Texts are text.
import { type ReactElement, useCallback, useState } from "react";
import type { Stop } from "../../tour/types.js";
import { usePlay, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { useAssetUrl } from "./use_asset_url.js";

interface TourCardProps {
  readonly stop: Stop;
  readonly arrived: boolean;
}

export function TourCard({ stop, arrived }: TourCardProps): ReactElement {
  const { controls } = usePlay();
  const { title, text, link, branches } = stop;
  return (
    <article className="player-card card" aria-label={title}>
      <h2>{title}</h2>
      {arrived ? (
        <div className="player-text">
          {text === "" ? null : <p className="player-words">{text}</p>}
          <StopPicture stop={stop} />
          {link === null ? null : (
            <p>
              <a href={link.url} target="_blank" rel="noopener noreferrer">
                {link.label}
              </a>
            </p>
          )}
        </div>
      ) : null}
      {arrived && branches.length > 0 ? (
        <div className="buttons">
          {branches.map(({ label }, i) => (
            // The place in the list is what a branch is known by.
            // biome-ignore lint/suspicious/noArrayIndexKey: see above
            <button key={i} type="button" onClick={() => controls.takeBranch(i)}>
              {label} <Icon name="next" size={16} />
            </button>
          ))}
        </div>
      ) : null}
    </article>
  );
}

function StopPicture({ stop: { picture } }: { readonly stop: Stop }): ReactElement | null {
  const name = useStore(({ documents }) => (picture === null ? "" : (documents.tour.assets.get(picture)?.name ?? "")));
  const [lost, setLost] = useState(false);
  const onLost = useCallback(() => setLost(true), []);
  const url = useAssetUrl(picture, onLost);
  if (picture === null) return null;
  if (lost) return <p className="hint">The picture “{name}” is missing.</p>;
  if (url === null) return null;
  return <img className="player-picture" src={url} alt={name} onError={onLost} />;
}
