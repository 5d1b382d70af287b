// Shaders of exact frames. Display values are written as they are: no tone mapping, no colour conversion.
import {
  CustomBlending,
  type DataTexture,
  DoubleSide,
  Matrix4,
  OneMinusSrcAlphaFactor,
  ShaderMaterial,
  SrcAlphaFactor,
  type Texture,
  Vector2,
  Vector3,
} from "three";

/** Clip box and map of errors act on the point in the scene that a pixel shows. */
const POINT_FUNCTIONS = `
#ifdef CLIP
uniform vec3 clipMin;
uniform vec3 clipMax;
#endif
#ifdef DRAPE
uniform sampler2D drapeMap;
uniform vec2 drapeMin;
uniform vec2 drapeMax;
#endif
vec3 finish(vec3 rgb, vec3 point) {
#ifdef CLIP
  if (any(lessThan(point, clipMin)) || any(greaterThan(point, clipMax))) discard;
#endif
#ifdef DRAPE
  vec2 onDrape = (point.xy - drapeMin) / (drapeMax - drapeMin);
  if (all(greaterThanEqual(onDrape, vec2(0.0))) && all(lessThanEqual(onDrape, vec2(1.0)))) {
    vec4 drape = texture2D(drapeMap, vec2(onDrape.x, 1.0 - onDrape.y));
    rgb = mix(rgb, drape.rgb, 0.8 * drape.a);
  }
#endif
  return rgb;
}`;

/** The point in the scene that a place of the frame shows, z ahead of its camera. */
export const FRAME_POINT = `uniform mat4 sceneFromCamera;
uniform vec2 halfSize;
uniform float perspective;
vec3 framePoint(vec2 uv, float z) {
  vec2 aside = (2.0 * uv - 1.0) * halfSize * mix(1.0, z, perspective);
  return (sceneFromCamera * vec4(aside, z, 1.0)).xyz;
}`;

/** The whole canvas, seen from the frame's own pose. */
const QUAD_VERTEX = `varying vec2 vUv;
void main() {
  vUv = vec2(0.5 + 0.5 * position.x, 0.5 - 0.5 * position.y);
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;
const QUAD_FRAGMENT = `uniform sampler2D colour;
uniform float opacity;
varying vec2 vUv;
#if defined(CLIP) || defined(DRAPE)
uniform sampler2D depth;
${FRAME_POINT}
${POINT_FUNCTIONS}
#endif
void main() {
  vec3 rgb = texture2D(colour, vUv).rgb;
#if defined(CLIP) || defined(DRAPE)
  ivec2 size = textureSize(depth, 0);
  ivec2 pixel = ivec2(vUv * vec2(textureSize(colour, 0)));
  float z = texelFetch(depth, min(pixel / 2, size - 1), 0).r;
  if (z > 0.0) rgb = finish(rgb, framePoint(vUv, z));
#ifdef CLIP
  else discard;
#endif
#endif
  gl_FragColor = vec4(rgb, opacity);
}`;

/** The frame as a surface, seen from elsewhere. */
const GRID_VERTEX = `varying vec2 vUv;
varying vec3 vPoint;
void main() {
  vUv = uv;
  vPoint = (modelMatrix * vec4(position, 1.0)).xyz;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
const GRID_FRAGMENT = `uniform sampler2D colour;
uniform float opacity;
varying vec2 vUv;
varying vec3 vPoint;
${POINT_FUNCTIONS}
void main() {
  gl_FragColor = vec4(finish(texture2D(colour, vUv).rgb, vPoint), opacity);
}`;

export interface ExactUniforms {
  readonly colour: { value: Texture | null };
  readonly depth: { value: DataTexture | null };
  readonly opacity: { value: number };
  readonly sceneFromCamera: { value: Matrix4 };
  /** Half the picture at distance 1, or in metres. */
  readonly halfSize: { value: Vector2 };
  readonly perspective: { value: number };
  readonly clipMin: { value: Vector3 };
  readonly clipMax: { value: Vector3 };
  readonly drapeMap: { value: Texture | null };
  readonly drapeMin: { value: Vector2 };
  readonly drapeMax: { value: Vector2 };
}

export function makeExactUniforms(): ExactUniforms {
  return {
    colour: { value: null },
    depth: { value: null },
    opacity: { value: 0 },
    sceneFromCamera: { value: new Matrix4() },
    halfSize: { value: new Vector2(1, 1) },
    perspective: { value: 1 },
    clipMin: { value: new Vector3() },
    clipMax: { value: new Vector3() },
    drapeMap: { value: null },
    drapeMin: { value: new Vector2() },
    drapeMax: { value: new Vector2(1, 1) },
  };
}

export function makeExactMaterial(kind: "quad" | "grid", uniforms: ExactUniforms): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: { ...uniforms },
    vertexShader: kind === "quad" ? QUAD_VERTEX : GRID_VERTEX,
    fragmentShader: kind === "quad" ? QUAD_FRAGMENT : GRID_FRAGMENT,
    // Over the mesh whatever its depth: the frame and the mesh show the same surface.
    depthTest: false,
    depthWrite: false,
    transparent: true,
    // The canvas stays opaque: only colours are mixed.
    blending: CustomBlending,
    blendSrc: SrcAlphaFactor,
    blendDst: OneMinusSrcAlphaFactor,
    side: DoubleSide,
    toneMapped: false,
  });
}

/** Compiles anew only when it must. */
export function setDefines(material: ShaderMaterial, clip: boolean, drape: boolean): void {
  const defines: Record<string, string> = {};
  if (clip) defines.CLIP = "";
  if (drape) defines.DRAPE = "";
  const before = Object.keys(material.defines ?? {}).join();
  if (before === Object.keys(defines).join()) return;
  material.defines = defines;
  material.needsUpdate = true;
}
