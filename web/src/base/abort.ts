// The error of something that was given up on purpose. Nobody needs to hear of it.

export class AbortError extends Error {
  constructor(message = "it was cancelled") {
    super(message);
    this.name = "AbortError";
  }
}

/** Also for the browser's own, which is a DOMException. */
export function isAbort(error: unknown): boolean {
  return typeof error === "object" && error !== null && "name" in error && error.name === "AbortError";
}

/** What to tell the user of an error of unknown kind. */
export function errorText(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
