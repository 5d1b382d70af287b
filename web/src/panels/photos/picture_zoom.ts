// Zoom and pan of a picture in a window. Picture pixels count from the outer corner of the upper left pixel, view pixels are CSS pixels of the window.
import type { Vec2 } from "../../base/vec.js";

export interface PictureZoom {
  /** CSS pixels per picture pixel. */
  readonly scale: number;
  /** Where the picture's upper left corner lies in the window. */
  readonly x: number;
  readonly y: number;
}

export interface Size {
  readonly w: number;
  readonly h: number;
}

export const LARGEST_SCALE = 8;

/** The whole picture, centred. */
export function fitPicture(view: Size, picture: Size): PictureZoom {
  const scale = fitScale(view, picture);
  return { scale, x: (view.w - picture.w * scale) / 2, y: (view.h - picture.h * scale) / 2 };
}

export function toPicture(zoom: PictureZoom, view: Vec2): Vec2 {
  return [(view[0] - zoom.x) / zoom.scale, (view[1] - zoom.y) / zoom.scale];
}

export function toView(zoom: PictureZoom, pixel: Vec2): Vec2 {
  return [pixel[0] * zoom.scale + zoom.x, pixel[1] * zoom.scale + zoom.y];
}

/** Another scale; what is under `at` (view pixels) stays there as far as the picture still fills the window. */
export function zoomTo(zoom: PictureZoom, scale: number, at: Vec2, view: Size, picture: Size): PictureZoom {
  if (!Number.isFinite(scale)) return zoom;
  const least = Math.min(fitScale(view, picture), LARGEST_SCALE);
  const next = Math.min(LARGEST_SCALE, Math.max(least, scale));
  const pixel = toPicture(zoom, at);
  return keepInside({ scale: next, x: at[0] - pixel[0] * next, y: at[1] - pixel[1] * next }, view, picture);
}

export function panBy(zoom: PictureZoom, delta: Vec2, view: Size, picture: Size): PictureZoom {
  return keepInside({ ...zoom, x: zoom.x + delta[0], y: zoom.y + delta[1] }, view, picture);
}

/** This pixel in the middle of the window at this scale. */
export function centreOn(pixel: Vec2, scale: number, view: Size, picture: Size): PictureZoom {
  const x = view.w / 2 - pixel[0] * scale;
  const y = view.h / 2 - pixel[1] * scale;
  const wanted = Math.min(LARGEST_SCALE, Math.max(Math.min(fitScale(view, picture), LARGEST_SCALE), scale));
  if (wanted !== scale) return centreOn(pixel, wanted, view, picture);
  return keepInside({ scale, x, y }, view, picture);
}

function fitScale(view: Size, picture: Size): number {
  if (!(picture.w > 0) || !(picture.h > 0) || !(view.w > 0) || !(view.h > 0)) return 1;
  return Math.min(view.w / picture.w, view.h / picture.h);
}

/** A side that is smaller than the window is centred, a larger one leaves no gap. */
function keepInside(zoom: PictureZoom, view: Size, picture: Size): PictureZoom {
  const place = (at: number, window: number, length: number): number =>
    length <= window ? (window - length) / 2 : Math.min(0, Math.max(window - length, at));
  return {
    scale: zoom.scale,
    x: place(zoom.x, view.w, picture.w * zoom.scale),
    y: place(zoom.y, view.h, picture.h * zoom.scale),
  };
}
