// One photo in full resolution, to mark a control point in it.
import { type KeyboardEvent, type PointerEvent, type ReactElement, useEffect, useRef, useState } from "react";
import type { Vec2 } from "../../base/vec.js";
import type { ControlPoint } from "../../state/app_state.js";
import { type MarkEntry, residualPx, withMark, withPoint } from "../../state/control_points.js";
import type { PhotoCamera } from "../../state/project.js";
import { photoUrl } from "../../state/project.js";
import { Cross } from "../photos/cross.js";
import { centreOn, fitPicture, type Size, toPicture, toView } from "../photos/picture_zoom.js";
import { usePictureZoom } from "../photos/use_picture_zoom.js";
import { useApp } from "../use_store.js";
import { IconButton } from "../widgets/icon_button.js";
import { ModalDialog } from "../widgets/modal_dialog.js";

interface MarkDialogProps {
  readonly point: ControlPoint;
  readonly entries: readonly MarkEntry[];
  readonly photo: number;
  readonly onPhoto: (photo: number) => void;
  readonly onClose: () => void;
}

export function MarkDialog({ point, entries, photo, onPhoto, onClose }: MarkDialogProps): ReactElement | null {
  const { store, project } = useApp();
  // Marked photos move up in the list: the order at opening is the one to step through.
  const [order] = useState(() => entries.filter((entry) => entry.photo.available).map((entry) => entry.photo.index));
  const entry = entries.find((candidate) => candidate.photo.index === photo);
  const camera = entry === undefined ? undefined : project.cameras[entry.photo.camera];
  if (entry === undefined || camera === undefined) return null;
  const step = (by: number): void => {
    const next = order[(order.indexOf(photo) + by + order.length) % order.length];
    if (next !== undefined) onPhoto(next);
  };
  const key = (event: KeyboardEvent): void => {
    const letter = event.ctrlKey || event.metaKey ? event.key.toLowerCase() : "";
    if (event.key === "PageUp" || event.key === "PageDown") step(event.key === "PageUp" ? -1 : 1);
    else if (letter === "y" || (letter === "z" && event.shiftKey)) store.redo();
    else if (letter === "z") store.undo();
    else return;
    event.preventDefault();
  };
  const residual = residualPx(entry);
  return (
    <ModalDialog
      label={`Mark ${point.name} in ${entry.photo.name}`}
      className="full-dialog"
      onClose={onClose}
      onKeyDown={key}
    >
      <header className="full-head">
        <IconButton icon="previous" label="Previous photo" keys={["PageUp"]} side="below" onClick={() => step(-1)} />
        <IconButton icon="next" label="Next photo" keys={["PageDown"]} side="below" onClick={() => step(1)} />
        <h2 className="full-title">
          {point.name} in {entry.photo.name}
        </h2>
        <span role="status">
          {entry.mark === null
            ? "Not marked"
            : `Mark ${entry.mark[0].toFixed(2)}, ${entry.mark[1].toFixed(2)}${residual === null ? "" : `: ${residual.toFixed(2)} px from the prediction`}`}
        </span>
        <span className="spring" />
        <IconButton icon="close" label="Close" keys={["Esc"]} side="left" onClick={onClose} />
      </header>
      <MarkPicture key={photo} point={point} entry={entry} camera={camera} />
    </ModalDialog>
  );
}

interface MarkPictureProps {
  readonly point: ControlPoint;
  readonly entry: MarkEntry;
  readonly camera: PhotoCamera;
}

function MarkPicture({ point, entry, camera }: MarkPictureProps): ReactElement {
  const { store } = useApp();
  const [source, setSource] = useState<"full" | "photo" | null>("full");
  const handle = useRef<HTMLButtonElement>(null);
  const picture: Size = { w: camera.width, h: camera.height };
  // Setting the mark must not move the picture under the pointer.
  const [begin] = useState(entry.mark ?? entry.predicted);
  const centre = entry.mark ?? entry.predicted;
  const grabbed = useRef<Vec2>([0, 0]);
  /** A new mark takes the focus as soon as its handle is there, so that arrow keys correct it. */
  const wantsFocus = useRef(false);
  const setMark = (pixel: Vec2 | null): void => {
    const inside: Vec2 | null = pixel === null ? null : [clamp(pixel[0], picture.w), clamp(pixel[1], picture.h)];
    store.changeDocuments(
      pixel === null ? "remove mark" : "mark control point",
      (documents) => withPoint(documents, point.name, (old) => withMark(old, entry.photo.name, inside)),
      `mark ${point.name} in ${entry.photo.name}`,
    );
  };
  const pictureWindow = usePictureZoom({
    picture,
    initial: (view) => (begin === null ? fitPicture(view, picture) : centreOn(begin, 1, view, picture)),
    onClick: (at) => {
      store.history.closeGroup();
      wantsFocus.current = true;
      setMark(toPicture(pictureWindow.zoom, at));
    },
  });
  const { ref, view, zoom, setZoom, zoomBy, handlers, key, place } = pictureWindow;
  useEffect(() => {
    // The picture takes over the focus of the former photo's one, which is gone.
    if (document.activeElement === document.body) ref.current?.focus({ preventScroll: true });
  }, [ref]);
  useEffect(() => {
    if (!wantsFocus.current || handle.current === null) return;
    wantsFocus.current = false;
    handle.current.focus({ preventScroll: true });
  });
  const mark = entry.mark;
  const markAt = mark === null ? null : toView(zoom, mark);
  const predictedAt = entry.predicted === null ? null : toView(zoom, entry.predicted);
  const drag = (event: PointerEvent<HTMLButtonElement>): void => {
    event.stopPropagation();
    if (!event.currentTarget.hasPointerCapture(event.pointerId) || event.buttons === 0) return;
    const at = place(event);
    setMark(toPicture(zoom, [at[0] - grabbed.current[0], at[1] - grabbed.current[1]]));
  };
  const markKey = (event: KeyboardEvent): void => {
    const nudge = NUDGES[event.key];
    if (mark === null) return;
    if (event.key === "Delete" || event.key === "Backspace") {
      event.preventDefault();
      store.history.closeGroup();
      setMark(null);
      ref.current?.focus({ preventScroll: true });
    } else if (nudge !== undefined) {
      event.preventDefault();
      event.stopPropagation();
      const px = event.shiftKey ? 1 : 0.25;
      setMark([mark[0] + nudge[0] * px, mark[1] + nudge[1] * px]);
    }
  };
  const windowKey = (event: KeyboardEvent): void => {
    if (event.target === ref.current && event.key === "Enter") {
      event.preventDefault();
      store.history.closeGroup();
      setMark(toPicture(zoom, [view.w / 2, view.h / 2]));
    } else if (event.target === ref.current && event.key === "Delete" && mark !== null) setMark(null);
    else key(event);
  };
  return (
    <>
      <div
        className="picture-window marking"
        ref={ref}
        {...handlers}
        onKeyDown={windowKey}
        // biome-ignore lint/a11y/noNoninteractiveTabindex: keys pan, zoom and mark here
        tabIndex={0}
        data-first-focus=""
        role="application"
        aria-label="Photo: arrow keys pan, plus and minus zoom, Enter marks the middle"
      >
        {source === null ? (
          <p className="picture-note">The photo's file cannot be loaded.</p>
        ) : (
          <img
            className={zoom.scale >= 4 ? "picture pixels" : "picture"}
            src={photoUrl(entry.photo.index, source)}
            alt={entry.photo.name}
            draggable={false}
            onError={() => setSource(source === "full" ? "photo" : null)}
            style={{
              width: picture.w * zoom.scale,
              height: picture.h * zoom.scale,
              transform: `translate(${zoom.x}px, ${zoom.y}px)`,
            }}
          />
        )}
        {predictedAt === null ? null : <Cross at={predictedAt} kind="predicted" />}
        {markAt === null || mark === null ? null : (
          <>
            <Cross at={markAt} kind="mark" />
            <button
              type="button"
              ref={handle}
              className="mark-handle"
              style={{ transform: `translate(${markAt[0] - 20}px, ${markAt[1] - 20}px)` }}
              aria-label={`Mark at ${mark[0].toFixed(2)}, ${mark[1].toFixed(2)}: arrow keys move it, Delete removes it`}
              onPointerDown={(event) => {
                event.stopPropagation();
                store.history.closeGroup();
                const at = place(event);
                grabbed.current = [at[0] - markAt[0], at[1] - markAt[1]];
                event.currentTarget.setPointerCapture(event.pointerId);
              }}
              onPointerMove={drag}
              onPointerUp={(event) => {
                event.stopPropagation();
                store.history.closeGroup();
              }}
              onKeyDown={markKey}
            />
          </>
        )}
      </div>
      <footer className="full-foot">
        <span className="hint">
          A click sets the mark, dragging it corrects it, arrow keys move it by a quarter pixel.
        </span>
        <span className="spring" />
        {mark === null ? null : (
          <button type="button" className="danger" onClick={() => setMark(null)}>
            Remove mark
          </button>
        )}
        {centre === null ? null : (
          <button type="button" onClick={() => setZoom(centreOn(centre, Math.max(1, zoom.scale), view, picture))}>
            Centre
          </button>
        )}
        <button type="button" onClick={() => zoomBy(1 / 1.5)} aria-label="Zoom out">
          −
        </button>
        <output className="zoom-value">{(zoom.scale * 100).toFixed(0)} %</output>
        <button type="button" onClick={() => zoomBy(1.5)} aria-label="Zoom in">
          +
        </button>
        <button type="button" onClick={() => setZoom(fitPicture(view, picture))}>
          Fit
        </button>
      </footer>
    </>
  );
}

function clamp(value: number, length: number): number {
  return Math.min(length, Math.max(0, value));
}

const NUDGES: Readonly<Record<string, Vec2>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};
