// An engine and a browser for tests of the link: sockets that the test answers by hand, a clock that it moves, pictures that it decodes when it wants.
import { deflateRawSync, inflateRawSync } from "node:zlib";
import { ManualClock } from "../../../src/base/clock.js";
import type { FrameBytes } from "../../../src/protocol/frame.js";
import { LinkCore } from "../../../src/protocol/link_core.js";
import type { Platform, SocketEvents } from "../../../src/protocol/link_platform.js";

export interface FrameFields {
  readonly seq?: number;
  readonly revision?: number;
  readonly pass?: number;
  readonly passes?: number;
  readonly format?: number;
  readonly flags?: number;
  readonly width?: number;
  readonly height?: number;
  readonly rotation?: readonly number[];
  readonly size?: number;
  readonly near?: number;
  readonly far?: number;
  /** Depth values; empty: no depth. */
  readonly depth?: readonly number[];
  readonly color?: readonly number[];
}

/** A frame as docs/viewer_protocol.md describes it: by default 5 x 3 pixels, perspective. */
export function frameBytes(fields: FrameFields = {}): ArrayBuffer {
  const { width = 5, height = 3, color = [1, 2, 3], depth = [0, 1, 65535, 32768, 2, 3] } = fields;
  const packed = depth.length === 0 ? new Uint8Array() : deflateRawSync(new Uint8Array(Uint16Array.from(depth).buffer));
  const bytes = new Uint8Array(128 + color.length + packed.length);
  const view = new DataView(bytes.buffer);
  bytes.set([..."SKYF"].map((letter) => letter.charCodeAt(0)));
  view.setUint16(4, 1, true);
  view.setUint16(6, 128, true);
  view.setUint32(8, fields.seq ?? 1, true);
  view.setUint32(12, fields.revision ?? 1, true);
  view.setUint8(16, fields.pass ?? 0);
  view.setUint8(17, fields.passes ?? 3);
  view.setUint8(18, fields.format ?? 1);
  view.setUint8(19, fields.flags ?? 0);
  [width, height, 0, 0, width, height].forEach((value, i) => {
    view.setUint16(20 + 2 * i, value, true);
  });
  [1.5, -2.5, 1e5, ...(fields.rotation ?? [0, 1, 0, 0]), fields.size ?? 60].forEach((value, i) => {
    view.setFloat64(32 + 8 * i, value, true);
  });
  view.setFloat32(96, fields.near ?? 2, true);
  view.setFloat32(100, fields.far ?? 10, true);
  view.setUint16(104, depth.length === 0 ? 0 : Math.ceil(width / 2), true);
  view.setUint16(106, depth.length === 0 ? 0 : Math.ceil(height / 2), true);
  view.setUint32(108, color.length, true);
  view.setUint32(112, packed.length, true);
  bytes.set(color, 128);
  bytes.set(packed, 128 + color.length);
  return bytes.buffer;
}

export function inflate(packed: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
  return new Promise((resolve) => resolve(new Uint8Array(inflateRawSync(packed))));
}

export interface FakeBitmap {
  readonly frame: FrameBytes;
  closed: boolean;
  close(): void;
}
export interface FakeSocket {
  readonly events: SocketEvents;
  /** What the link sent, parsed. */
  readonly sent: Record<string, unknown>[];
  closed: boolean;
}

export const ENGINE = { ready: true, reason: "", revision: 1, exposure: "normal", clients: 1, ranks: 1 };

/** All promises that can go on have gone on. */
export function settled(): Promise<void> {
  return new Promise((resolve) => setImmediate(resolve));
}

export class Bench {
  readonly clock = new ManualClock();
  readonly sockets: FakeSocket[] = [];
  readonly bitmaps: FakeBitmap[] = [];
  readonly warnings: string[] = [];
  /** When set, decoding waits until the test calls it. */
  holdDecoding = false;
  readonly held: (() => void)[] = [];
  decodeFails = false;
  readonly link: LinkCore<FakeBitmap>;

  constructor() {
    const platform: Platform<FakeBitmap> = {
      clock: this.clock,
      open: (events) => {
        const socket: FakeSocket = { events, sent: [], closed: false };
        this.sockets.push(socket);
        return {
          send: (text) => {
            socket.sent.push(JSON.parse(text));
          },
          close: () => {
            socket.closed = true;
          },
        };
      },
      decode: (frame) => this.decode(frame),
      inflate,
      warn: (text) => this.warnings.push(text),
    };
    this.link = new LinkCore(platform);
  }

  private async decode(frame: FrameBytes): Promise<FakeBitmap> {
    if (this.holdDecoding) await new Promise<void>((resolve) => this.held.push(resolve));
    if (this.decodeFails) throw new Error("damaged picture");
    const bitmap: FakeBitmap = {
      frame,
      closed: false,
      close: () => {
        bitmap.closed = true;
      },
    };
    this.bitmaps.push(bitmap);
    return bitmap;
  }

  get socket(): FakeSocket {
    const last = this.sockets[this.sockets.length - 1];
    if (last === undefined) throw new Error("the link has no socket");
    return last;
  }

  /** Texts of this type that were sent on the newest connection. */
  sent(type: string): Record<string, unknown>[] {
    return this.socket.sent.filter((message) => message.type === type);
  }

  text(message: unknown): void {
    this.socket.events.onText(typeof message === "string" ? message : JSON.stringify(message));
  }

  welcome(engine: Record<string, unknown> = {}): void {
    this.socket.events.onOpen();
    this.text({ type: "welcome", version: 1, client: 7, engine: { ...ENGINE, ...engine } });
  }
}
