// A window on a picture: wheel, two fingers and keys zoom, dragging pans, a press without a move is a click.
import {
  type KeyboardEvent,
  type PointerEvent,
  type RefObject,
  useEffect,
  useLayoutEffect,
  useRef,
  useState,
} from "react";
import type { Vec2 } from "../../base/vec.js";
import { fitPicture, type PictureZoom, panBy, type Size, zoomTo } from "./picture_zoom.js";

const CLICK_PX = 4;
const KEY_PAN_PX = 40;
const KEY_ZOOM = 1.25;

interface Options {
  readonly picture: Size;
  /** Where it begins; the whole picture when left out. */
  readonly initial?: (view: Size) => PictureZoom;
  /** View pixels. */
  readonly onClick?: (at: Vec2) => void;
}

export interface PictureWindow {
  readonly ref: RefObject<HTMLDivElement | null>;
  readonly view: Size;
  readonly zoom: PictureZoom;
  readonly setZoom: (zoom: PictureZoom | null) => void;
  readonly zoomBy: (factor: number) => void;
  readonly handlers: {
    readonly onPointerDown: (event: PointerEvent<HTMLDivElement>) => void;
    readonly onPointerMove: (event: PointerEvent<HTMLDivElement>) => void;
    readonly onPointerUp: (event: PointerEvent<HTMLDivElement>) => void;
    readonly onPointerCancel: (event: PointerEvent<HTMLDivElement>) => void;
  };
  /** Returns true when the key was one of zoom or pan. */
  readonly key: (event: KeyboardEvent) => boolean;
  /** View pixels of a pointer event. */
  readonly place: (event: { readonly clientX: number; readonly clientY: number }) => Vec2;
}

export function usePictureZoom({ picture, initial, onClick }: Options): PictureWindow {
  const ref = useRef<HTMLDivElement>(null);
  const [view, setView] = useState<Size>({ w: 0, h: 0 });
  const [chosen, setChosen] = useState<PictureZoom | null>(null);
  const pointers = useRef(new Map<number, Vec2>());
  const travelled = useRef(0);
  const zoom = chosen ?? (initial ?? ((size: Size) => fitPicture(size, picture)))(view);

  useLayoutEffect(() => {
    const element = ref.current;
    if (element === null) return;
    const measure = (): void => setView({ w: element.clientWidth, h: element.clientHeight });
    measure();
    const observer = new ResizeObserver(measure);
    observer.observe(element);
    return () => observer.disconnect();
  }, []);

  const place = (event: { readonly clientX: number; readonly clientY: number }): Vec2 => {
    const box = ref.current?.getBoundingClientRect();
    return box === undefined ? [0, 0] : [event.clientX - box.left, event.clientY - box.top];
  };
  const change = (next: (zoom: PictureZoom) => PictureZoom): void => setChosen((old) => next(old ?? zoom));
  const zoomAt = (factor: number, at: Vec2): void => change((z) => zoomTo(z, z.scale * factor, at, view, picture));

  const wheel = useRef((_: WheelEvent): void => {});
  useEffect(() => {
    wheel.current = (event) => {
      event.preventDefault();
      const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 20 : 1;
      zoomAt(1.0015 ** -(event.deltaY * lines), place(event));
    };
  });
  useEffect(() => {
    const element = ref.current;
    if (element === null) return;
    // React's own wheel listeners are passive and could not keep the page from scrolling.
    const listener = (event: WheelEvent): void => wheel.current(event);
    element.addEventListener("wheel", listener, { passive: false });
    return () => element.removeEventListener("wheel", listener);
  }, []);

  const onPointerDown = (event: PointerEvent<HTMLDivElement>): void => {
    if (event.button !== 0) return;
    if (pointers.current.size === 0) travelled.current = 0;
    pointers.current.set(event.pointerId, place(event));
    event.currentTarget.setPointerCapture(event.pointerId);
  };
  const onPointerMove = (event: PointerEvent<HTMLDivElement>): void => {
    const before = pointers.current.get(event.pointerId);
    if (before === undefined) return;
    const now = place(event);
    const other = [...pointers.current].find(([id]) => id !== event.pointerId)?.[1];
    pointers.current.set(event.pointerId, now);
    const delta: Vec2 = [now[0] - before[0], now[1] - before[1]];
    travelled.current += Math.hypot(...delta) + (other === undefined ? 0 : CLICK_PX);
    if (other === undefined) {
      if (travelled.current >= CLICK_PX) change((z) => panBy(z, delta, view, picture));
      return;
    }
    const apart = (a: Vec2): number => Math.max(1, Math.hypot(a[0] - other[0], a[1] - other[1]));
    const middle: Vec2 = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
    change((z) =>
      panBy(
        zoomTo(z, (z.scale * apart(now)) / apart(before), middle, view, picture),
        [delta[0] / 2, delta[1] / 2],
        view,
        picture,
      ),
    );
  };
  const onPointerUp = (event: PointerEvent<HTMLDivElement>): void => {
    const mine = pointers.current.delete(event.pointerId);
    if (mine && pointers.current.size === 0 && travelled.current < CLICK_PX) onClick?.(place(event));
  };
  const onPointerCancel = (event: PointerEvent<HTMLDivElement>): void => {
    pointers.current.delete(event.pointerId);
    travelled.current = CLICK_PX;
  };

  const zoomBy = (factor: number): void => zoomAt(factor, [view.w / 2, view.h / 2]);
  const key = (event: KeyboardEvent): boolean => {
    const pan = PAN_KEYS[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (event.key === "+" || event.key === "=") zoomBy(KEY_ZOOM);
    else if (event.key === "-") zoomBy(1 / KEY_ZOOM);
    else if (event.key === "0") setChosen(fitPicture(view, picture));
    else if (event.key === "1") zoomAt(1 / zoom.scale, [view.w / 2, view.h / 2]);
    else if (pan !== undefined) change((z) => panBy(z, [pan[0] * KEY_PAN_PX, pan[1] * KEY_PAN_PX], view, picture));
    else return false;
    event.preventDefault();
    return true;
  };
  const handlers = { onPointerDown, onPointerMove, onPointerUp, onPointerCancel };
  return { ref, view, zoom, setZoom: setChosen, zoomBy, handlers, key, place };
}

const PAN_KEYS: Readonly<Record<string, Vec2>> = {
  ArrowLeft: [1, 0],
  ArrowRight: [-1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};
