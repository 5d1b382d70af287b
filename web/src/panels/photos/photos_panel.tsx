// Photos: those that see the chosen point, or all of the survey.
import { type ReactElement, useState } from "react";
import { formatLength } from "../../geo/format.js";
import { photoUrl } from "../../state/project.js";
import { useApp, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { Psnr } from "../widgets/psnr.js";
import { openCompare } from "./open_compare.js";
import { listPhotos, PAGE, type PhotoEntry } from "./photo_list.js";

export function PhotosPanel(): ReactElement {
  const context = useApp();
  const { store, project } = context;
  const sights = useStore((state) => state.sights);
  const [search, setSearch] = useState("");
  const [shown, setShown] = useState(PAGE);
  const entries = listPhotos(project.photos, sights?.photos ?? null, search);
  const visible = entries.filter((entry) => entry.sight?.visible === true).length;
  return (
    <>
      <div className="search">
        <Icon name="search" size={16} />
        <input
          type="search"
          placeholder="Search by name"
          aria-label="Search photos by name"
          value={search}
          onChange={(event) => {
            setSearch(event.currentTarget.value);
            setShown(PAGE);
          }}
        />
      </div>
      {sights === null ? (
        <p className="hint">
          {entries.length} photos. To list those that see a point, take the photos tool and click the surface.
        </p>
      ) : (
        <div className="sights-head">
          <p role="status">
            {visible} photos see the point
            {sights.checked ? "" : ". Whether something hides it could not be checked without the field"}
          </p>
          <button type="button" onClick={() => store.set({ sights: null })}>
            All photos
          </button>
        </div>
      )}
      <ul className="photo-list">
        {entries.slice(0, shown).map((entry) => (
          <PhotoRow key={entry.photo.index} entry={entry} onOpen={() => void openCompare(context, entry.photo)} />
        ))}
      </ul>
      {entries.length === 0 ? <p className="hint">No photo.</p> : null}
      {entries.length > shown ? (
        <button type="button" className="wide" onClick={() => setShown(shown + PAGE)}>
          Show {Math.min(PAGE, entries.length - shown)} more of {entries.length}
        </button>
      ) : null}
    </>
  );
}

function PhotoRow({ entry, onOpen }: { readonly entry: PhotoEntry; readonly onOpen: () => void }): ReactElement {
  const { photo, sight } = entry;
  const hidden = sight !== null && !sight.visible;
  return (
    <li>
      <button type="button" className={hidden ? "photo-row hidden-photo" : "photo-row"} onClick={onOpen}>
        {photo.available ? (
          <img src={photoUrl(photo.index, "thumbnail")} loading="lazy" decoding="async" alt={photo.name} />
        ) : (
          <span className="no-picture">no file</span>
        )}
        <span className="photo-text">
          <span className="photo-name">{photo.name}</span>
          {sight === null ? null : (
            <span className="hint">
              {(sight.gsdM * 100).toFixed(1)} cm/px, {formatLength(sight.distanceM)}
            </span>
          )}
          <span className="badges">
            {hidden ? <span className="badge">hidden</span> : null}
            {photo.isTest ? <span className="badge badge-strong">held-out</span> : null}
            {photo.psnrDb === null ? null : <Psnr valueDb={photo.psnrDb} />}
          </span>
        </span>
      </button>
    </li>
  );
}
