// The depth of an exact frame as the depth buffer has it, so that whatever is drawn afterwards is hidden by what the frame shows. Where the frame has no
// surface nothing hides; where the clip box cuts the frame away the depth of the mesh stays, which is seen there.
import { AlwaysDepth, type Camera, DoubleSide, ShaderMaterial, Vector4 } from "three";
import { type ExactUniforms, FRAME_POINT, setDefines } from "./exact_material.js";

const VERTEX = `varying vec2 vUv;
void main() {
  vUv = vec2(0.5 + 0.5 * position.x, 0.5 - 0.5 * position.y);
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;
// Along a plane 1/z is linear over a perspective picture, and z over an orthographic one: between samples the depth of planes is exact, so that the
// line in which a model stands on the ground is smooth. At holes it is that of the nearest sample.
const FRAGMENT = `uniform sampler2D colour;
uniform sampler2D depth;
uniform vec4 projection;
varying vec2 vUv;
${FRAME_POINT}
#ifdef CLIP
uniform vec3 clipMin;
uniform vec3 clipMax;
#endif
float depthAt(ivec2 at) {
  return texelFetch(depth, clamp(at, ivec2(0), textureSize(depth, 0) - 1), 0).r;
}
float nearestDepth() {
  return depthAt(ivec2(vUv * vec2(textureSize(colour, 0))) / 2);
}
float smoothDepth() {
  // Sample (i, j) is at the middle of the frame's pixel (2i, 2j).
  vec2 at = 0.5 * (vUv * vec2(textureSize(colour, 0)) - 0.5);
  ivec2 low = ivec2(floor(at));
  vec2 part = at - vec2(low);
  vec4 z = vec4(depthAt(low), depthAt(low + ivec2(1, 0)), depthAt(low + ivec2(0, 1)), depthAt(low + ivec2(1, 1)));
  if (any(lessThanEqual(z, vec4(0.0)))) return nearestDepth();
  if (perspective > 0.5) z = 1.0 / z;
  float mixed = mix(mix(z.x, z.y, part.x), mix(z.z, z.w, part.x), part.y);
  return perspective > 0.5 ? 1.0 / mixed : mixed;
}
void main() {
  float z = smoothDepth();
#ifdef CLIP
  // The same test as that of the picture, so that both are cut along the same line.
  float shown = nearestDepth();
  vec3 point = framePoint(vUv, shown);
  if (shown <= 0.0 || any(lessThan(point, clipMin)) || any(greaterThan(point, clipMax))) discard;
#endif
  gl_FragColor = vec4(0.0);
  gl_FragDepth = z <= 0.0 ? 1.0 : clamp(0.5 + 0.5 * (projection.y - projection.x * z) / (projection.w - projection.z * z), 0.0, 1.0);
}`;

export class FrameDepthMaterial extends ShaderMaterial {
  private readonly row = new Vector4();

  constructor(uniforms: ExactUniforms) {
    super({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      // Nothing is written without the test.
      depthTest: true,
      depthFunc: AlwaysDepth,
      depthWrite: true,
      colorWrite: false,
      side: DoubleSide,
    });
    this.uniforms = { ...uniforms, projection: { value: this.row } };
  }

  /** Before each drawing. */
  prepare(camera: Camera, clip: boolean): void {
    const e = camera.projectionMatrix.elements;
    // Of the depth and of the number it is divided by, both from z of three's camera, which looks along -z.
    this.row.set(e[10] ?? 0, e[14] ?? 0, e[11] ?? 0, e[15] ?? 0);
    setDefines(this, clip, false);
  }
}
