// The connection to the engine in the browser: WebSocket, picture decoder and inflater for link_core.ts.
import { systemClock } from "../base/clock.js";
import { decodePicture, inflate } from "./browser_decode.js";
import type { FrameBytes } from "./frame.js";
import type { Link } from "./link_api.js";
import { LinkCore } from "./link_core.js";
import type { Platform, Socket, SocketEvents } from "./link_platform.js";

/** The engine's address on the server that the page came from. */
function ownUrl(): string {
  const url = new URL("/ws", window.location.href);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  return url.href;
}

function openSocket(url: string, events: SocketEvents): Socket {
  const socket = new WebSocket(url);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => events.onOpen();
  // An error is always followed by a close.
  socket.onclose = () => events.onClose();
  socket.onmessage = (event: MessageEvent<unknown>) => {
    if (typeof event.data === "string") events.onText(event.data);
    else if (event.data instanceof ArrayBuffer) events.onBytes(event.data);
  };
  return {
    send: (text) => {
      if (socket.readyState === WebSocket.OPEN) socket.send(text);
    },
    close: () => socket.close(),
  };
}

function decode({ header, color }: FrameBytes): Promise<ImageBitmap> {
  return decodePicture(color, header.format === "png" ? "image/png" : "image/jpeg").then((bitmap) => {
    if (bitmap.width === header.width && bitmap.height === header.height) return bitmap;
    const found = `${bitmap.width} x ${bitmap.height}`;
    bitmap.close();
    throw new Error(`the picture is ${found}, its header says ${header.width} x ${header.height}`);
  });
}

/** Connects, and again whenever the connection is lost, until close(). */
export function connect(options: { readonly url?: string } = {}): Link {
  const url = options.url ?? ownUrl();
  const platform: Platform<ImageBitmap> = {
    clock: systemClock,
    open: (events) => openSocket(url, events),
    decode,
    inflate,
    warn: (text) => console.warn(text),
  };
  const core = new LinkCore(platform);
  return {
    view: (parameters) => core.view(parameters),
    viewPhoto: (photo, w) => core.viewPhoto(photo, w),
    stop: () => core.stop(),
    onFrame: (listener) => core.onFrame(listener),
    onEngine: (listener) => core.onEngine(listener),
    onProgress: (listener) => core.onProgress(listener),
    pick: (ray, project) => core.pick(ray, project),
    photosAt: (point) => core.photosAt(point),
    profile: (from, to, samples, project) => core.profile(from, to, samples, project),
    volume: (polygon, base, baseHeightM, project) => core.volume(polygon, base, baseHeightM, project),
    errorMap: () => core.errorMap(),
    trustMap: () => core.trustMap(),
    cancel: (id) => core.cancel(id),
    statistics: () => core.statistics(),
    close: () => core.close(),
  };
}
