// What the browser's WebGL can do, asked once before the renderer is made, because antialiasing is chosen when a context is made.

export interface WebglSupport {
  /** Drawn by the processor: everything that costs pixels or triangles is left out. */
  readonly software: boolean;
}

export const NO_WEBGL2 =
  "This browser offers no WebGL 2, which the 3-D view needs. Switch on hardware acceleration in the browser's settings, or use a current Firefox, " +
  "Chrome, Edge or Safari.";

/** Throws an Error for the user when there is no WebGL 2. */
export function webglSupport(): WebglSupport {
  const canvas = document.createElement("canvas");
  canvas.width = 1;
  canvas.height = 1;
  const gl = canvas.getContext("webgl2");
  if (gl === null) throw new Error(NO_WEBGL2);
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name: unknown = gl.getParameter(info === null ? gl.RENDERER : info.UNMASKED_RENDERER_WEBGL);
  // Browsers allow few contexts at a time.
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return { software: typeof name === "string" && /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name) };
}
