// Camera path: key frames, speed, preview, and the file that `skyquilt render --path` reads.
import { type ChangeEvent, type ReactElement, useState } from "react";
import { parseJson } from "../../base/check.js";
import { formatLength } from "../../geo/format.js";
import type { CameraPath } from "../../state/app_state.js";
import {
  FASTEST_MPS,
  framesBetween,
  pathLengthM,
  pathSeconds,
  SLOWEST_MPS,
  VIDEO_FPS,
} from "../../state/camera_path.js";
import { readCameraPath, writeCameraPath } from "../../state/camera_path_file.js";
import { addErrorNotice, addNotice } from "../../state/notices.js";
import type { AppContext } from "../context.js";
import { useStore } from "../use_store.js";
import { CopyLine } from "../widgets/copy_line.js";
import { downloadText } from "../widgets/download.js";
import { Icon } from "../widgets/icons.js";
import { NumberField } from "../widgets/number_field.js";
import { changePath, KeyFrameList } from "./key_frame_list.js";
import { usePathPreview } from "./path_preview.js";

const LARGEST_FILE_BYTES = 4 * 1024 * 1024;

export function PathPanel({ context }: { readonly context: AppContext }): ReactElement {
  const { commands, project } = context;
  const path = useStore((state) => state.documents.cameraPath);
  const preview = usePathPreview(context, path);
  const { keys } = path;
  return (
    <>
      <section>
        <div className="buttons">
          <button
            type="button"
            className="primary"
            disabled={preview.playing}
            onClick={() => void commands.run("path.add")}
          >
            <Icon name="add" size={16} /> Add this view
          </button>
          <LoadButton context={context} />
        </div>
        {keys.length === 0 ? (
          <p className="hint">
            No key frames yet. Move to a view and add it; the camera then flies from one to the next.
          </p>
        ) : (
          <KeyFrameList context={context} keys={keys} />
        )}
      </section>
      {keys.length < 2 ? null : (
        <section>
          <h3>Flight</h3>
          <NumberField
            label="Speed"
            value={path.speedMps}
            digits={2}
            unit="m/s"
            onChange={(value) => setSpeed(context, value)}
          />
          <dl className="facts">
            <Fact name="Length" value={formatLength(pathLengthM(keys))} />
            <Fact name="Time" value={timeText(pathSeconds(path))} />
          </dl>
          <div className="buttons">
            <button type="button" onClick={preview.playing ? preview.stop : preview.start}>
              {preview.playing ? "Stop (Esc)" : "Preview"}
            </button>
            {preview.playing ? <progress aria-label="Preview" max={1} value={preview.fraction} /> : null}
          </div>
          <p className="hint">Each section takes the same time, in the preview as in the video.</p>
        </section>
      )}
      {keys.length === 0 ? null : (
        <section>
          <h3>Render it</h3>
          <p className="hint">{renderText(path)}</p>
          <CopyLine text={renderCommand(project.name, keys.length > 1)} />
          <p className="hint">
            Run it in the folder that holds <code>{project.name}</code>.
          </p>
          <div className="buttons">
            <button type="button" onClick={() => saveFile(context, path)}>
              Export camera_path.json
            </button>
          </div>
        </section>
      )}
    </>
  );
}

function Fact({ name, value }: { readonly name: string; readonly value: string }): ReactElement {
  return (
    <div className="fact">
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  );
}

function renderText(path: CameraPath): string {
  if (path.keys.length === 1) return "The program renders this view as a picture:";
  const frames = (path.keys.length - 1) * (framesBetween(path) + 1) + 1;
  return `The program renders ${frames} frames for ${VIDEO_FPS} frames a second (products.video_fps). The path is saved in the project:`;
}

/** Quoted for a shell where the name needs it. */
function renderCommand(folder: string, video: boolean): string {
  const quote = (text: string) => (/^[\w.+@%/-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
  const safe = folder.startsWith("-") ? `./${folder}` : folder;
  return `skyquilt render ${quote(safe)} --path ${quote(`${safe}/camera_path.json`)}${video ? " --video" : ""}`;
}

function timeText(seconds: number): string {
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)} min ${String(whole % 60).padStart(2, "0")} s`;
}

function setSpeed({ store }: AppContext, value: number): void {
  const speedMps = Math.min(FASTEST_MPS, Math.max(SLOWEST_MPS, value));
  changePath(store, "change speed", (path) => ({ ...path, speedMps }), "speed");
}

function saveFile({ store }: AppContext, path: CameraPath): void {
  try {
    downloadText("camera_path.json", "application/json", writeCameraPath(path));
  } catch (error) {
    addErrorNotice(store, "The file could not be made", error);
  }
}

function LoadButton({ context }: { readonly context: AppContext }): ReactElement {
  const { store, project } = context;
  const [reading, setReading] = useState(false);
  const load = async (event: ChangeEvent<HTMLInputElement>): Promise<void> => {
    const input = event.currentTarget;
    const file = input.files?.[0];
    if (file === undefined) return;
    setReading(true);
    try {
      if (file.size > LARGEST_FILE_BYTES) throw new Error("the file is larger than 4 MiB");
      const path = readCameraPath(parseJson(await file.text(), "the file"), project);
      changePath(store, "load camera path", () => path);
      addNotice(store, "info", `${path.keys.length} key frames were loaded from ${file.name}.`);
    } catch (error) {
      addErrorNotice(store, file.name, error);
    } finally {
      setReading(false);
      // The same file can be chosen again after it was corrected.
      input.value = "";
    }
  };
  return (
    <label className="button-like">
      <Icon name="open" size={16} /> Load
      <input
        type="file"
        className="sr-only"
        accept=".json,application/json"
        disabled={reading}
        onChange={(event) => void load(event)}
      />
    </label>
  );
}
