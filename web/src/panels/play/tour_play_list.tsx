// All stops of the tour that is played, and what had to be left out.
import type { ReactElement } from "react";
import { usePlay, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";

export function TourPlayList({ onChosen }: { readonly onChosen: () => void }): ReactElement {
  const { controls } = usePlay();
  const tour = useStore(({ documents }) => documents.tour);
  const play = useStore((state) => state.play);
  const missing = useStore((state) => state.tour.missing);
  return (
    <nav className="player-list card" aria-label="All stops">
      {tour.title === "" ? null : <h2>{tour.title}</h2>}
      <ol>
        {tour.stops.map(({ id, title }, i) => (
          <li key={id}>
            <button
              type="button"
              className="point-row"
              aria-current={id === play?.stop?.id ? "step" : undefined}
              onClick={() => {
                controls.goTo(id);
                onChosen();
              }}
            >
              <span className="point-name">
                {i + 1}. {title}
              </span>
              {play?.seen.includes(id) === true ? <Icon name="check" size={16} /> : null}
            </button>
          </li>
        ))}
      </ol>
      {missing.length === 0 ? null : (
        <details className="hint">
          <summary>Not all of this tour can be shown</summary>
          <ul>
            {missing.map((sentence) => (
              <li key={sentence}>{sentence}</li>
            ))}
          </ul>
        </details>
      )}
    </nav>
  );
}
