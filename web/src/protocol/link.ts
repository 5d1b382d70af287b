// The connection to the engine in the browser: WebSocket, picture decoder and inflater for link_core.ts.
import { systemClock } from "../base/clock.js";
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

function decode(frame: FrameBytes): Promise<ImageBitmap> {
  const type = frame.header.format === "png" ? "image/png" : "image/jpeg";
  // Without these options the browser may change the values, and the lossless pass must arrive bit by bit.
  return createImageBitmap(new Blob([frame.color], { type }), {
    colorSpaceConversion: "none",
    premultiplyAlpha: "none",
  }).then((bitmap) => {
    if (bitmap.width === frame.header.width && bitmap.height === frame.header.height) return bitmap;
    const found = `${bitmap.width} x ${bitmap.height}`;
    bitmap.close();
    throw new Error(`the picture is ${found}, its header says ${frame.header.width} x ${frame.header.height}`);
  });
}

/** Stops at one byte more than expected, so that a damaged frame cannot fill the memory. */
async function inflate(packed: Uint8Array<ArrayBuffer>, bytes: number): Promise<Uint8Array<ArrayBuffer>> {
  const out = new Uint8Array(bytes);
  const reader = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  let filled = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (filled + value.byteLength > bytes) {
      await reader.cancel();
      throw new Error(`the depth is longer than ${bytes} bytes`);
    }
    out.set(value, filled);
    filled += value.byteLength;
  }
  return out.subarray(0, filled);
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
    cancel: (id) => core.cancel(id),
    statistics: () => core.statistics(),
    close: () => core.close(),
  };
}
