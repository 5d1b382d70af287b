// A button that uploads a picture or a model of the tour, and how far it is.
import { type ChangeEvent, type ReactElement, useEffect, useRef } from "react";
import { addErrorNotice } from "../../state/notices.js";
import { setTourView } from "../../state/tour_changes.js";
import type { NamedAsset } from "../../tour/edit_assets.js";
import type { AssetKind } from "../context.js";
import { useApp, useStore } from "../use_store.js";
import { Icon } from "../widgets/icons.js";

const ACCEPT: Readonly<Record<AssetKind, string>> = {
  picture: ".png,.jpg,.jpeg,image/png,image/jpeg",
  model: ".glb,model/gltf-binary",
};

interface UploadButtonProps {
  readonly kind: AssetKind;
  readonly label: string;
  /** The file is in the project. */
  readonly onDone: (asset: NamedAsset) => void;
}

export function UploadButton({ kind, label, onDone }: UploadButtonProps): ReactElement {
  const { store, assets } = useApp();
  const busy = useStore(({ tour }) => tour.upload !== null);
  // What it was for may be gone when the file has arrived.
  const wanted = useRef(onDone);
  wanted.current = onDone;
  useEffect(() => {
    const kept = wanted;
    return () => {
      kept.current = () => {};
    };
  }, []);
  const upload = async (event: ChangeEvent<HTMLInputElement>): Promise<void> => {
    const input = event.currentTarget;
    const file = input.files?.[0];
    if (file === undefined) return;
    setTourView(store, { upload: { name: file.name, fraction: null } });
    try {
      const asset = await assets.upload(file, kind, (fraction) =>
        setTourView(store, { upload: { name: file.name, fraction } }),
      );
      wanted.current(asset);
    } catch (error) {
      addErrorNotice(store, `${file.name} was not uploaded`, error);
    } finally {
      setTourView(store, { upload: null });
      // The same file can be chosen again after it was corrected.
      input.value = "";
    }
  };
  return (
    <label className={busy ? "button-like busy-button" : "button-like"}>
      <Icon name="open" size={16} /> {label}
      <input
        type="file"
        className="sr-only"
        accept={ACCEPT[kind]}
        disabled={busy}
        onChange={(event) => void upload(event)}
      />
    </label>
  );
}

export function UploadProgress(): ReactElement | null {
  const upload = useStore(({ tour }) => tour.upload);
  if (upload === null) return null;
  const { name, fraction } = upload;
  return (
    <div role="status">
      <p className="hint">Uploading {name} …</p>
      {fraction === null ? (
        <progress aria-label={`Uploading ${name}`} />
      ) : (
        <progress aria-label={`Uploading ${name}`} max={1} value={fraction} />
      )}
    </div>
  );
}
