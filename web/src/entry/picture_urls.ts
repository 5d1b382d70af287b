// Pictures of an exported tour as addresses that the page can show: made of bytes, the last few kept.
import type { LoadBytes } from "../scene/load_bytes.js";

/** Up to 50 MB each. */
const KEPT = 6;

export class PictureUrls {
  private readonly load: LoadBytes;
  private readonly made = new Map<string, Promise<string>>();

  constructor(load: LoadBytes) {
    this.load = load;
  }

  /** Rejects with an Error for the user. */
  get(url: string): Promise<string> {
    const known = this.made.get(url) ?? this.make(url);
    this.made.delete(url);
    this.made.set(url, known);
    for (const [oldest, address] of this.made) {
      if (this.made.size <= KEPT) break;
      this.made.delete(oldest);
      address.then(
        (made) => URL.revokeObjectURL(made),
        () => {},
      );
    }
    return known;
  }

  private async make(url: string): Promise<string> {
    const bytes = await this.load(url, new AbortController().signal);
    return URL.createObjectURL(new Blob([bytes], { type: url.endsWith(".png") ? "image/png" : "image/jpeg" }));
  }
}
