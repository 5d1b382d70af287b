// The connection to the engine without the browser: what is said when, which frames are shown, when to connect again. Socket, decoder and clock are
// passed in, so that it is tested in Node. link.ts joins it to the browser.
import { AbortError, errorText } from "../base/abort.js";
import { asObject, parseJson } from "../base/check.js";
import { Emitter } from "../base/emitter.js";
import type { Vec2, Vec3 } from "../base/vec.js";
import type { DrapedMap, ErrorMap, VolumeBase } from "../state/app_state.js";
import { type FrameBytes, inflateDepth, parseFrame } from "./frame.js";
import { FrameOrder } from "./frame_order.js";
import type { DecodedFrame, LinkStatus, Platform, Socket, SocketEvents } from "./link_platform.js";
import {
  ackText,
  cancelText,
  errorMapText,
  helloText,
  PROTOCOL_VERSION,
  photosAtText,
  pickText,
  profileText,
  type RayFields,
  stopText,
  trustMapText,
  type ViewFields,
  viewPhotoText,
  viewText,
  volumeText,
} from "./messages.js";
import {
  type EngineText,
  type PhotosText,
  type PickedText,
  type ProfileText,
  readServerText,
  type VolumeText,
} from "./replies.js";
import { NewestWins, type ProgressListener, type RequestOptions, Requests } from "./requests.js";

export const LOST = "connection lost: is `skyquilt view` still running?";
const RESTARTED = " If it was started again, open the newest link that it printed.";
const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;
const WELCOME_MS = 10_000;
const PICK_MS = 30_000;
const QUERY_MS = 120_000;
const LONG_QUERY = { timeoutMs: 600_000, shown: true } as const;

export class LinkCore<Bitmap extends { close(): void }> {
  private readonly platform: Platform<Bitmap>;
  private readonly frames = new Emitter<[DecodedFrame<Bitmap>]>();
  private readonly engine = new Emitter<[LinkStatus]>();
  private readonly progress = new Emitter<Parameters<ProgressListener>>();
  private readonly order = new FrameOrder();
  private readonly requests: Requests;
  private readonly picks = new NewestWins<PickedText>(2);
  private socket: Socket | null = null;
  /** Counts connections: what belongs to an older one is recognised by it. */
  private epoch = 0;
  private welcomed = false;
  private everWelcomed = false;
  private closed = false;
  private failures = 0;
  private stopWaiting: () => void = () => {};
  private seq = 0;
  /** The view that the camera rests at; sent again after a new connection. */
  private restingText: string | null = null;
  private status: LinkStatus = {
    connected: false,
    ready: false,
    reason: "connecting",
    revision: 0,
    exposure: "",
    clients: 0,
    ranks: 1,
  };
  private badMessages = 0;
  private droppedFrames = 0;
  private reconnects = 0;

  constructor(platform: Platform<Bitmap>) {
    this.platform = platform;
    this.requests = new Requests(
      platform.clock,
      (text) => this.send(text),
      cancelText,
      (...event) => this.progress.emit(...event),
    );
    this.connect();
  }

  // ---- connection ----

  private connect(): void {
    if (this.closed) return;
    this.epoch += 1;
    const epoch = this.epoch;
    this.welcomed = false;
    const current = () => epoch === this.epoch && !this.closed;
    const events: SocketEvents = {
      onOpen: () => {
        if (current()) this.socket?.send(helloText());
      },
      onText: (text) => {
        if (current()) this.onText(text);
      },
      onBytes: (bytes) => {
        if (current()) this.onBytes(bytes);
      },
      onClose: () => {
        if (current()) this.lost(null);
      },
    };
    // A server that accepts and then says nothing is as good as none.
    this.stopWaiting = this.platform.clock.after(WELCOME_MS, () => {
      if (current() && !this.welcomed) this.lost(null);
    });
    try {
      this.socket = this.platform.open(events);
    } catch (error) {
      this.lost(errorText(error));
    }
  }

  /** The connection is over; the next one is tried after a while that doubles from 0.5 to 8 s. */
  private lost(reason: string | null): void {
    this.stopWaiting();
    this.epoch += 1;
    const socket = this.socket;
    this.socket = null;
    this.welcomed = false;
    socket?.close();
    const waitMs = Math.min(LONGEST_WAIT_MS, FIRST_WAIT_MS * 2 ** this.failures);
    this.failures += 1;
    const text = reason ?? (this.failures > 3 ? LOST + RESTARTED : LOST);
    this.setStatus({ ...this.status, connected: false, ready: false, reason: text });
    this.requests.failAll(new Error(text));
    this.stopWaiting = this.platform.clock.after(waitMs, () => this.connect());
  }

  private setStatus(next: LinkStatus): void {
    const before = this.status;
    this.status = next;
    const keys = ["connected", "ready", "reason", "revision", "exposure", "clients", "ranks"] as const;
    if (keys.some((key) => before[key] !== next[key])) this.engine.emit(next);
  }

  private send(text: string): boolean {
    if (!this.welcomed || this.socket === null) return false;
    this.socket.send(text);
    return true;
  }

  private bad(what: string): void {
    this.badMessages += 1;
    if (this.badMessages === 1) this.platform.warn(`a message of the engine was not understood: ${what}`);
  }

  private onText(text: string): void {
    let message: ReturnType<typeof readServerText>;
    try {
      message = readServerText(text);
    } catch (error) {
      this.bad(errorText(error));
      this.failNamed(text, errorText(error));
      return;
    }
    if (message === null) {
      this.bad("its type is unknown");
      return;
    }
    switch (message.type) {
      case "welcome":
        this.onWelcome(message.version, message.engine);
        return;
      case "engine":
        this.onEngineText(message.engine);
        return;
      case "progress":
        this.requests.onProgress(message.id, message.fraction);
        return;
      case "error":
        if (message.id !== null) this.requests.fail(message.id, new Error(message.message));
        else if (!this.welcomed) this.lost(message.message);
        else this.bad(`it refused one of ours: ${message.message}`);
        return;
      case "picked":
      case "photos":
      case "profile":
      case "volume":
      case "error_map":
      case "trust_map":
        if (!this.requests.answer(message.id, message.type, message.value))
          this.bad(`nobody asked for "${message.type}"`);
        return;
      default: {
        const never: never = message;
        throw new Error(`unknown message ${String(never)}`);
      }
    }
  }

  /** An answer that cannot be read must not leave its request waiting. */
  private failNamed(text: string, why: string): void {
    try {
      const { id } = asObject(parseJson(text, "message"), "message");
      if (typeof id === "number") this.requests.fail(id, new Error(`the engine's answer was not understood (${why})`));
    } catch {
      // No JSON, so no id either.
    }
  }

  private onWelcome(version: number, engine: EngineText): void {
    if (version !== PROTOCOL_VERSION) {
      this.lost("this page and the program are of different versions: reload the page");
      return;
    }
    if (this.welcomed) return;
    this.stopWaiting();
    this.welcomed = true;
    this.failures = 0;
    if (this.everWelcomed) this.reconnects += 1;
    this.everWelcomed = true;
    this.order.restart();
    this.onEngineText(engine);
    if (this.restingText !== null) this.send(this.restingText);
  }

  private onEngineText(engine: EngineText): void {
    this.order.setRevision(engine.revision);
    if (this.welcomed) this.setStatus({ ...engine, connected: true });
  }

  // ---- frames ----

  private onBytes(bytes: ArrayBuffer): void {
    let frame: FrameBytes;
    try {
      frame = parseFrame(bytes);
    } catch (error) {
      this.bad(errorText(error));
      return;
    }
    if (!this.order.wanted(frame.header)) {
      this.droppedFrames += 1;
      this.send(ackText(frame.header.seq, frame.header.pass));
      return;
    }
    // It handles its own errors.
    void this.decode(frame, this.epoch);
  }

  private async decode(frame: FrameBytes, epoch: number): Promise<void> {
    const { header } = frame;
    const [bitmap, depth] = await Promise.allSettled([
      this.platform.decode(frame),
      inflateDepth(frame, this.platform.inflate),
    ]);
    const current = epoch === this.epoch && !this.closed;
    // Also for a damaged frame: the engine would wait for it for ever.
    if (current) this.send(ackText(header.seq, header.pass));
    if (bitmap.status === "rejected" || depth.status === "rejected") {
      if (bitmap.status === "fulfilled") bitmap.value.close();
      const error: unknown =
        bitmap.status === "rejected" ? bitmap.reason : depth.status === "rejected" ? depth.reason : null;
      if (current) this.bad(`frame: ${errorText(error)}`);
      return;
    }
    if (!current || !this.order.wanted(header)) {
      this.droppedFrames += 1;
      bitmap.value.close();
      return;
    }
    this.order.shown(header);
    const { format: _, ...rest } = header;
    if (this.frames.size === 0) bitmap.value.close();
    else this.frames.emit({ ...rest, bitmap: bitmap.value, depthM: depth.value });
  }

  // ---- what link_api.ts offers ----

  private rest(text: (seq: number) => string): number {
    this.seq += 1;
    const seq = this.seq;
    this.order.wantFrom(seq);
    try {
      this.restingText = text(seq);
    } catch (error) {
      if (!(error instanceof RangeError)) throw error;
      // The camera is where the engine cannot follow (too far out, say): no exact frames there.
      this.restingText = null;
      this.send(stopText(seq));
      return seq;
    }
    this.send(this.restingText);
    return seq;
  }

  view(parameters: ViewFields): number {
    return this.rest((seq) => viewText(seq, parameters));
  }

  viewPhoto(photo: number, w: number): number {
    return this.rest((seq) => viewPhotoText(seq, photo, w));
  }

  stop(): void {
    if (this.restingText === null) return;
    this.restingText = null;
    this.order.wantFrom(this.seq + 1);
    this.send(stopText(this.seq));
  }

  onFrame(listener: (frame: DecodedFrame<Bitmap>) => void): () => void {
    return this.frames.on(listener);
  }

  /** Calls the listener at once with what is known. */
  onEngine(listener: (status: LinkStatus) => void): () => void {
    const end = this.engine.on(listener);
    listener(this.status);
    return end;
  }

  onProgress(listener: ProgressListener): () => void {
    return this.progress.on(listener);
  }

  private request<T>(options: Omit<RequestOptions<T>, "narrow">): Promise<T> {
    if (this.closed) return Promise.reject(new AbortError("the connection was closed"));
    // requests.answer compares the type of the answer, which readServerText has checked member by member.
    return this.requests.start(
      { ...options, narrow: (value) => value as T },
      this.status.connected ? LOST : this.whyNot(),
    );
  }

  private whyNot(): string {
    return this.everWelcomed || this.failures > 0
      ? this.status.reason
      : "the engine is not connected yet: try again in a moment";
  }

  pick(ray: RayFields, project: "main" | "before" = "main"): Promise<PickedText> {
    const text = (id: number) => pickText(id, ray, project);
    return this.picks.start(() =>
      this.request<PickedText>({ what: "Point", answer: "picked", timeoutMs: PICK_MS, shown: false, text }),
    );
  }

  photosAt(point: Vec3): Promise<PhotosText> {
    const text = (id: number) => photosAtText(id, point);
    return this.request({ what: "Photos of the point", answer: "photos", timeoutMs: QUERY_MS, shown: true, text });
  }

  profile(from: Vec2, to: Vec2, samples: number, project: "main" | "before" = "main"): Promise<ProfileText> {
    const text = (id: number) => profileText(id, from, to, samples, project);
    return this.request({ what: "Profile", answer: "profile", timeoutMs: QUERY_MS, shown: true, text });
  }

  volume(
    polygon: readonly Vec2[],
    base: VolumeBase,
    baseHeightM: number,
    project: "main" | "before" = "main",
  ): Promise<VolumeText> {
    const text = (id: number) => volumeText(id, polygon, base, baseHeightM, project);
    return this.request({ ...LONG_QUERY, what: "Volume", answer: "volume", text });
  }

  errorMap(): Promise<ErrorMap> {
    return this.request({ ...LONG_QUERY, what: "Error map", answer: "error_map", text: errorMapText });
  }

  trustMap(): Promise<DrapedMap> {
    return this.request({ ...LONG_QUERY, what: "Error to expect", answer: "trust_map", text: trustMapText });
  }

  cancel(id: number): void {
    this.requests.cancel(id);
  }

  statistics(): { readonly badMessages: number; readonly droppedFrames: number; readonly reconnects: number } {
    return { badMessages: this.badMessages, droppedFrames: this.droppedFrames, reconnects: this.reconnects };
  }

  close(): void {
    if (this.closed) return;
    this.closed = true;
    this.stopWaiting();
    const socket = this.socket;
    this.socket = null;
    this.welcomed = false;
    socket?.close();
    this.requests.failAll(new AbortError("the connection was closed"));
    this.frames.clear();
    this.engine.clear();
    this.progress.clear();
  }
}
