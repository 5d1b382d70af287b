// The files of an exported tour. On file:// nothing may be fetched, but classic scripts run: each file below data/ is one that calls
// skyquiltData("NAME", "BASE64"). This registry adds the script of a file when it is first wanted. packed_scripts.ts joins it to the page.
import { errorText } from "../base/abort.js";
import { bytesFromBase64 } from "../base/base64.js";
import type { Clock } from "../base/clock.js";

export type Bytes = Uint8Array<ArrayBuffer>;

export interface ScriptHost {
  /** Adds a classic script. One of the two is called once, `ran` after the script has run. Returns the function that takes it out again. */
  add(url: string, ran: () => void, failed: () => void): () => void;
}

export interface PackedFilesOptions {
  readonly scripts: ScriptHost;
  readonly clock: Clock;
  /** A server that accepts and then says nothing is as good as none. */
  readonly mostWaitMs?: number;
}

const MOST_WAIT_MS = 120_000;
const LONGEST_NAME = 300;

interface Waiting {
  readonly promise: Promise<Bytes>;
  readonly resolve: (bytes: Bytes) => void;
  readonly reject: (error: Error) => void;
  readonly end: () => void;
}

export class PackedFiles {
  private readonly options: Required<PackedFilesOptions>;
  private readonly waiting = new Map<string, Waiting>();
  private readonly loaded = new Map<string, Promise<Bytes>>();

  constructor(options: PackedFilesOptions) {
    this.options = { mostWaitMs: MOST_WAIT_MS, ...options };
  }

  /** What the scripts call. A file that nobody asked for (its script is in the page itself) is kept too. */
  receive(name: unknown, base64: unknown): void {
    if (typeof name !== "string" || typeof base64 !== "string") return;
    const waits = this.waiting.get(name);
    if (waits === undefined && this.loaded.has(name)) return;
    let bytes: Bytes;
    try {
      bytes = bytesFromBase64(base64);
    } catch (error) {
      this.fail(name, `the file ${fileOf(name)} is damaged, ${errorText(error)}: export the tour again`);
      return;
    }
    if (waits === undefined) {
      this.loaded.set(name, Promise.resolve(bytes));
      return;
    }
    this.waiting.delete(name);
    this.loaded.set(name, waits.promise);
    waits.end();
    waits.resolve(bytes);
  }

  /** The bytes of a file; all who ask get the same. Rejects with an Error for the user, and then tries again when asked again. */
  load(name: string): Promise<Bytes> {
    const known = this.loaded.get(name) ?? this.waiting.get(name)?.promise;
    if (known !== undefined) return known;
    if (!isFileName(name))
      return Promise.reject(new Error(`"${name.slice(0, 100)}" is no name of a file of this tour`));
    return this.begin(name);
  }

  /** Whoever has the bytes keeps them; the next load() reads the file again. */
  release(name: string): void {
    this.loaded.delete(name);
  }

  private begin(name: string): Promise<Bytes> {
    const { scripts, clock, mostWaitMs } = this.options;
    let resolve: (bytes: Bytes) => void = () => {};
    let reject: (error: Error) => void = () => {};
    const promise = new Promise<Bytes>((done, failed) => {
      resolve = done;
      reject = failed;
    });
    let remove = (): void => {};
    const stopClock = clock.after(mostWaitMs, () =>
      this.fail(
        name,
        `the file ${fileOf(name)} did not come within ${Math.round(mostWaitMs / 1000)} s: reload the page`,
      ),
    );
    const end = (): void => {
      stopClock();
      remove();
    };
    const own: Waiting = { promise, resolve, reject, end };
    this.waiting.set(name, own);
    const url = `data/${name.split("/").map(encodeURIComponent).join("/")}.js`;
    // A late event of a script that was given up says nothing of a later one.
    const failed = (why: string) => {
      if (this.waiting.get(name) === own) this.fail(name, why);
    };
    remove = scripts.add(
      url,
      () => failed(`the file ${fileOf(name)} is damaged, it holds something else: export the tour again`),
      () =>
        failed(
          `the file ${fileOf(name)} could not be loaded: the folder of the tour must be complete, with all that is in data/`,
        ),
    );
    return promise;
  }

  private fail(name: string, why: string): void {
    const waits = this.waiting.get(name);
    if (waits === undefined) return;
    this.waiting.delete(name);
    waits.end();
    waits.reject(new Error(why));
  }
}

function fileOf(name: string): string {
  return `data/${name}.js`;
}

/** A relative path that stays below data/. */
export function isFileName(name: string): boolean {
  if (name.length > LONGEST_NAME || /[\p{Cc}\p{Cs}\\]/u.test(name)) return false;
  return name.split("/").every((part) => part !== "" && part !== "." && part !== "..");
}

/**
 * The name of the file that a URL of the viewer's server ("/data/...") stands for in an exported tour; null: it is none. The page may be on a drive of
 * Windows, where file: addresses keep its letter.
 */
export function packedName(url: string): string | null {
  const path = /^(?:[a-z][a-z0-9+.-]*:(?:\/\/[^/]*)?)?(?:\/[A-Za-z]:)?\/data\/([^?#]+)/i.exec(url)?.[1];
  if (path === undefined) return null;
  let name: string;
  try {
    name = decodeURIComponent(path);
  } catch {
    return null;
  }
  // Uploaded pictures and models have a shorter path here.
  name = name.replace(/^tour\/assets\//, "assets/");
  return isFileName(name) ? name : null;
}
