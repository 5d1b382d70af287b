// The page that is shown when the viewer cannot start: what is wrong and what to do.
import type { ReactElement } from "react";
import { errorText } from "../base/abort.js";

export class StartError extends Error {
  readonly advice: string;

  constructor(message: string, advice: string) {
    super(message);
    this.name = "StartError";
    this.advice = advice;
  }
}

/** Throws a StartError when the browser cannot draw 3-D. */
export function requireWebGl2(): void {
  const context = document.createElement("canvas").getContext("webgl2");
  if (context === null) {
    throw new StartError(
      "This browser offers no WebGL 2, which draws the 3-D view",
      "Switch on hardware acceleration in the browser's settings, or use a current Firefox, Chrome, Edge or Safari.",
    );
  }
  // Browsers allow only few contexts at a time.
  context.getExtension("WEBGL_lose_context")?.loseContext();
}

interface StartErrorPageProps {
  readonly error: unknown;
  readonly title?: string;
}

export function StartErrorPage({ error, title = "The viewer could not start" }: StartErrorPageProps): ReactElement {
  const advice = error instanceof StartError ? error.advice : "";
  return (
    <main className="start-page" role="alert">
      <h1>{title}</h1>
      <p>{sentence(errorText(error))}</p>
      {advice === "" ? null : <p>{advice}</p>}
      <button type="button" className="primary" onClick={() => window.location.reload()}>
        Try again
      </button>
    </main>
  );
}

function sentence(text: string): string {
  const begun = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(begun) ? begun : `${begun}.`;
}
