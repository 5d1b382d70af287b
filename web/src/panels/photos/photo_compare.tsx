// A photo over the whole window beside the field's render from exactly its camera, with a line between the two.
import type { KeyboardEvent, PointerEvent, ReactElement } from "react";
import type { Vec2 } from "../../base/vec.js";
import { photoPose } from "../../state/photo_pose.js";
import type { Photo, PhotoCamera } from "../../state/project.js";
import { photoUrl } from "../../state/project.js";
import { useApp, useStore } from "../use_store.js";
import { IconButton } from "../widgets/icon_button.js";
import { ModalDialog } from "../widgets/modal_dialog.js";
import { Psnr } from "../widgets/psnr.js";
import { stepOfKey } from "../widgets/slider_keys.js";
import { Cross } from "./cross.js";
import { listPhotos, stepPhoto } from "./photo_list.js";
import { fitPicture, toView } from "./picture_zoom.js";
import { usePhotoRender } from "./use_photo_render.js";
import { usePictureZoom } from "./use_picture_zoom.js";

export function PhotoCompareView(): ReactElement | null {
  const { store, scene, project } = useApp();
  const index = useStore((state) => state.compare?.photo ?? null);
  const sights = useStore((state) => state.sights);
  const photo = index === null ? undefined : project.photos[index];
  const camera = photo === undefined ? undefined : project.cameras[photo.camera];
  if (photo === undefined || camera === undefined) return null;
  const close = (): void => store.set({ compare: null });
  const step = (by: number): void => {
    const next = stepPhoto(listPhotos(project.photos, sights?.photos ?? null, ""), photo.index, by);
    const other = next === null ? undefined : project.photos[next];
    const compare = store.get().compare;
    if (other === undefined || compare === null) return;
    store.set({ compare: { ...compare, photo: other.index } });
    void scene.flyTo(photoPose(project, other), 0);
  };
  const key = (event: KeyboardEvent): void => {
    if (event.key === "PageUp" || event.key === "PageDown") {
      event.preventDefault();
      step(event.key === "PageUp" ? -1 : 1);
    }
  };
  return (
    <ModalDialog label={`Photo ${photo.name} and its render`} className="full-dialog" onClose={close} onKeyDown={key}>
      <header className="full-head">
        <IconButton icon="previous" label="Previous photo" keys={["PageUp"]} side="below" onClick={() => step(-1)} />
        <IconButton icon="next" label="Next photo" keys={["PageDown"]} side="below" onClick={() => step(1)} />
        <h2 className="full-title">{photo.name}</h2>
        {photo.isTest ? <span className="badge badge-strong">held-out</span> : null}
        {photo.psnrDb === null ? null : <Psnr valueDb={photo.psnrDb} />}
        <span className="spring" />
        <IconButton icon="close" label="Close" keys={["Esc"]} side="left" onClick={close} />
      </header>
      <Pictures key={photo.index} photo={photo} camera={camera} />
    </ModalDialog>
  );
}

function Pictures({ photo, camera }: { readonly photo: Photo; readonly camera: PhotoCamera }): ReactElement {
  const { store } = useApp();
  const split = useStore((state) => state.compare?.split ?? 0.5);
  const sight = useStore((state) => state.sights?.photos.find((candidate) => candidate.photo === photo.index) ?? null);
  const picture = { w: camera.width, h: camera.height };
  const { ref, view, zoom, setZoom, zoomBy, handlers, key } = usePictureZoom({ picture });
  const fitScale = fitPicture(view, picture).scale;
  const { canvas, status } = usePhotoRender(photo.index, camera, view.w === 0 ? 0 : fitScale, zoom.scale);
  const move = (to: number): void => {
    const compare = store.get().compare;
    if (compare !== null) store.set({ compare: { ...compare, split: Math.min(1, Math.max(0, to)) } });
  };
  const drag = (event: PointerEvent<HTMLDivElement>): void => {
    event.stopPropagation();
    if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
    const box = ref.current?.getBoundingClientRect();
    if (box !== undefined && box.width > 0) move((event.clientX - box.left) / box.width);
  };
  const placed = {
    width: picture.w * zoom.scale,
    height: picture.h * zoom.scale,
    transform: `translate(${zoom.x}px, ${zoom.y}px)`,
  };
  const at: Vec2 | null = sight === null ? null : toView(zoom, sight.pixel);
  return (
    <>
      {/* biome-ignore lint/a11y/noStaticElementInteractions: dragging and the wheel have keys and buttons as their equal */}
      <div className="picture-window" ref={ref} {...handlers} onKeyDown={key}>
        <canvas className="picture" ref={canvas} style={placed} aria-label={`Render of ${photo.name}`} role="img" />
        <div className="picture-side" style={{ clipPath: `inset(0 ${(1 - split) * 100}% 0 0)` }}>
          {photo.available ? (
            <img
              className="picture"
              src={photoUrl(photo.index, "photo")}
              alt={photo.name}
              draggable={false}
              style={placed}
            />
          ) : (
            <p className="picture-note">The photo's file is missing.</p>
          )}
        </div>
        {at === null ? null : <Cross at={at} kind="mark" />}
        <span className="picture-name picture-name-left">Photo</span>
        <span className="picture-name picture-name-right">Render{status === "" ? "" : `: ${status}`}</span>
        <div className="swipe" style={{ left: `${split * 100}%` }}>
          <div
            className="swipe-grip"
            role="slider"
            tabIndex={0}
            aria-label="Line between photo and render"
            aria-valuemin={0}
            aria-valuemax={100}
            aria-valuenow={Math.round(split * 100)}
            aria-valuetext={`${Math.round(split * 100)} % photo`}
            data-first-focus=""
            ref={keepFocus}
            onPointerDown={(event) => {
              event.stopPropagation();
              event.currentTarget.setPointerCapture(event.pointerId);
            }}
            onPointerMove={drag}
            onKeyDown={(event) => {
              const paging = event.key === "PageUp" || event.key === "PageDown";
              const next = paging ? null : stepOfKey(event.key, event.shiftKey, split);
              if (next === null) return;
              event.preventDefault();
              event.stopPropagation();
              move(next);
            }}
          />
        </div>
      </div>
      <footer className="full-foot">
        <span className="hint">Wheel or + − zooms, dragging pans, arrow keys move the line.</span>
        <span className="spring" />
        <button type="button" onClick={() => zoomBy(1 / 1.5)} aria-label="Zoom out">
          −
        </button>
        <output className="zoom-value">{(zoom.scale * 100).toFixed(0)} %</output>
        <button type="button" onClick={() => zoomBy(1.5)} aria-label="Zoom in">
          +
        </button>
        <button type="button" onClick={() => setZoom(null)}>
          Fit
        </button>
      </footer>
    </>
  );
}

/** The next photo's line takes over the focus of the one that is gone; the line is what one wants to move. */
function keepFocus(element: HTMLDivElement | null): void {
  if (document.activeElement === document.body) element?.focus({ preventScroll: true });
}
