// What link_core.ts needs of the browser, and what it gives: without the DOM library, so that Node can test it.
import type { Clock } from "../base/clock.js";
import type { FrameBytes, FrameHeader, Inflate } from "./frame.js";
import type { EngineText } from "./replies.js";

/** One WebSocket. Callbacks are set before anything can arrive. */
export interface Socket {
  send(text: string): void;
  close(): void;
}
export interface SocketEvents {
  onOpen(): void;
  onText(text: string): void;
  onBytes(bytes: ArrayBuffer): void;
  /** Closed or failed; called once. */
  onClose(): void;
}
export interface Platform<Bitmap extends { close(): void }> {
  readonly clock: Clock;
  open(events: SocketEvents): Socket;
  /** JPEG or PNG to pixels, without colour conversion. */
  decode(frame: FrameBytes): Promise<Bitmap>;
  inflate: Inflate;
  warn(text: string): void;
}

/** A decoded frame (link_api.ts, ExactFrame). */
export interface DecodedFrame<Bitmap> extends Omit<FrameHeader, "format"> {
  readonly bitmap: Bitmap;
  readonly depthM: Float32Array;
}
export interface LinkStatus extends EngineText {
  readonly connected: boolean;
}
