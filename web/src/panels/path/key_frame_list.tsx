// The key frames of the camera path in order; the chosen one can be changed.
import { type ReactElement, useState } from "react";
import type { CameraPath, CameraPose, KeyFrame } from "../../state/app_state.js";
import { keyPose, movedKey } from "../../state/camera_path.js";
import type { Store } from "../../state/store.js";
import type { AppContext } from "../context.js";
import { Icon } from "../widgets/icons.js";
import { TextField } from "../widgets/text_field.js";

export function changePath(
  store: Store,
  label: string,
  change: (path: CameraPath) => CameraPath,
  group?: string,
): void {
  store.changeDocuments(
    label,
    (documents) => {
      const cameraPath = change(documents.cameraPath);
      return cameraPath === documents.cameraPath ? documents : { ...documents, cameraPath };
    },
    group,
  );
}

interface KeyFrameListProps {
  readonly context: AppContext;
  readonly keys: readonly KeyFrame[];
}

export function KeyFrameList({ context, keys }: KeyFrameListProps): ReactElement {
  const [chosen, setChosen] = useState<number | null>(null);
  const { store, scene } = context;
  const goTo = (pose: CameraPose): void => {
    if (store.get().navigation === "top") store.set({ navigation: "map" });
    void scene.flyTo(pose);
  };
  const change = (label: string, i: number, next: (key: KeyFrame) => KeyFrame): void =>
    changePath(store, label, (path) => ({ ...path, keys: path.keys.map((key, k) => (k === i ? next(key) : key)) }));
  const move = (i: number, to: number): void => {
    changePath(store, "move key frame", (path) => ({ ...path, keys: movedKey(path.keys, i, to) }));
    setChosen(to);
  };
  const remove = (i: number): void => {
    changePath(store, "delete key frame", (path) => ({ ...path, keys: path.keys.filter((_, k) => k !== i) }));
    setChosen(null);
  };
  return (
    <ol className="points">
      {keys.map((key, i) => {
        const open = chosen === i;
        return (
          // The place in the path is what a key frame is known by: names may be the same.
          // biome-ignore lint/suspicious/noArrayIndexKey: see above
          <li key={i} className={open ? "point-item selected" : "point-item"}>
            <button
              type="button"
              className="point-row"
              aria-expanded={open}
              onClick={() => {
                setChosen(open ? null : i);
                if (!open) goTo(key.pose);
              }}
            >
              <span className="point-name">
                {i + 1}. {key.name}
              </span>
            </button>
            {open ? (
              <div className="point-form">
                <TextField
                  label="Name"
                  value={key.name}
                  onChange={(name) => change("rename key frame", i, (old) => ({ ...old, name }))}
                />
                <div className="buttons">
                  <button type="button" onClick={() => goTo(key.pose)}>
                    <Icon name="focus" size={16} /> Go there
                  </button>
                  <button
                    type="button"
                    onClick={() => change("update key frame", i, (old) => ({ ...old, pose: keyPose(scene) }))}
                  >
                    Set to this view
                  </button>
                  <button type="button" disabled={i === 0} onClick={() => move(i, i - 1)}>
                    Earlier
                  </button>
                  <button type="button" disabled={i === keys.length - 1} onClick={() => move(i, i + 1)}>
                    Later
                  </button>
                  <button type="button" className="danger" onClick={() => remove(i)}>
                    <Icon name="remove" size={16} /> Delete
                  </button>
                </div>
              </div>
            ) : null}
          </li>
        );
      })}
    </ol>
  );
}
