// Which frames are shown: in the order (seq, pass) only forwards, none of a view that was given up, none of another scene revision.

export interface FrameKey {
  readonly seq: number;
  readonly pass: number;
  readonly revision: number;
}

export class FrameOrder {
  private lastSeq = 0;
  private lastPass = -1;
  private firstWanted = 0;
  private revision: number | null = null;

  /** Views before `seq` are no longer wanted. */
  wantFrom(seq: number): void {
    this.firstWanted = Math.max(this.firstWanted, seq);
  }

  /** Frames of other revisions are dropped from now on; null: any. */
  setRevision(revision: number | null): void {
    // The same view comes again, from its first pass, when the scene was loaded anew.
    if (revision !== this.revision) this.restart();
    this.revision = revision;
  }

  /** Another connection: its frames begin anew. */
  restart(): void {
    this.lastSeq = 0;
    this.lastPass = -1;
    this.revision = null;
  }

  /** Would this frame be shown now? Asked before decoding and again after it. */
  wanted(frame: FrameKey): boolean {
    if (frame.seq < this.firstWanted) return false;
    if (this.revision !== null && frame.revision !== this.revision) return false;
    return frame.seq > this.lastSeq || (frame.seq === this.lastSeq && frame.pass > this.lastPass);
  }

  /** It is shown. */
  shown(frame: FrameKey): void {
    this.lastSeq = frame.seq;
    this.lastPass = frame.pass;
  }
}
