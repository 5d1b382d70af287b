// Picture and link of a stop.
import type { ReactElement } from "react";
import { CheckError } from "../../base/check.js";
import { changeTour } from "../../state/tour_changes.js";
import { changeStop, setPicture } from "../../tour/edit_stops.js";
import { asUrl } from "../../tour/text_rules.js";
import type { WebLink } from "../../tour/types.js";
import { useApp } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { LineField } from "../widgets/line_field.js";
import type { StopFormProps } from "./stop_form_props.js";
import { UploadButton } from "./tour_upload.js";

export function TourStopMedia({ tour, stop }: StopFormProps): ReactElement {
  const { store, assets } = useApp();
  const { id, picture, link } = stop;
  const setLink = (next: WebLink | null): void => {
    changeTour(store, "change link", (old) => changeStop(old, id, { link: next }));
  };
  const name = picture === null ? "" : (tour.assets.get(picture)?.name ?? "");
  return (
    <>
      <div className="field">
        <span className="field-label">Picture</span>
        {picture === null ? null : <img className="tour-thumbnail" src={assets.url(picture)} alt={name} title={name} />}
        <UploadButton
          kind="picture"
          label={picture === null ? "Choose" : "Replace"}
          onDone={(asset) => changeTour(store, "set picture", (old) => setPicture(old, id, asset))}
        />
        {picture === null ? null : (
          <button
            type="button"
            className="quiet danger"
            aria-label="Remove the picture"
            title="Remove the picture"
            onClick={() => changeTour(store, "remove picture", (old) => setPicture(old, id, null))}
          >
            <Icon name="remove" size={16} />
          </button>
        )}
      </div>
      <LineField
        label="Link"
        value={link?.url ?? ""}
        empty
        placeholder="Address of a web page"
        problem={urlProblem}
        onChange={(url) => setLink(url === "" ? null : { url, label: link?.label ?? hostOf(url) })}
      />
      {link === null ? null : (
        <LineField label="Link's text" value={link.label} onChange={(label) => setLink({ ...link, label })} />
      )}
    </>
  );
}

function urlProblem(text: string): string | null {
  try {
    asUrl(text, "link");
    return null;
  } catch (error) {
    if (!(error instanceof CheckError)) throw error;
    return "An address that begins with https:// or http:// is needed.";
  }
}

/** What stands after the slashes, as far as it names a place. */
function hostOf(url: string): string {
  return (
    url
      .replace(/^https?:\/\//, "")
      .split(/[/?#]/)[0]
      ?.slice(0, 100) || "More"
  );
}
