// How surfaces are drawn: their picture as it is, without light and without colour conversion, clipped by the clip box, and with a map of errors
// laid over it from above when one is on.
import { FrontSide, LinearFilter, Matrix4, MeshBasicMaterial, type Plane, Texture, Vector2 } from "three";

export interface Drape {
  readonly texture: Texture | null;
  /** Corners in scene coordinates. */
  readonly min: Vector2;
  readonly max: Vector2;
}

const VERTEX_HEAD = "varying vec2 vDrape;\nvoid main() {";
const VERTEX_BODY = "#include <project_vertex>\n  vDrape = (modelMatrix * vec4(transformed, 1.0)).xy;";
const FRAGMENT_HEAD = `uniform sampler2D drapeMap;
uniform vec2 drapeMin;
uniform vec2 drapeMax;
varying vec2 vDrape;
void main() {`;
// The first row of the picture is the north.
const FRAGMENT_BODY = `#include <map_fragment>
  vec2 onDrape = (vDrape - drapeMin) / (drapeMax - drapeMin);
  if (all(greaterThanEqual(onDrape, vec2(0.0))) && all(lessThanEqual(onDrape, vec2(1.0)))) {
    vec4 drape = texture2D(drapeMap, vec2(onDrape.x, 1.0 - onDrape.y));
    diffuseColor.rgb = mix(diffuseColor.rgb, drape.rgb, 0.8 * drape.a);
  }`;

/** Shared by all materials of surfaces; a change reaches those that exist and those that will. */
export class SurfaceStyle {
  private readonly materials = new Set<MeshBasicMaterial>();
  private planes: Plane[] = [];
  private readonly uniforms = {
    drapeMap: { value: null as Texture | null },
    drapeMin: { value: new Vector2() },
    drapeMax: { value: new Vector2(1, 1) },
  };

  /** Not yet one that changes reach: adopt() when it is to stay. */
  makeMaterial(map: Texture | null, vertexColors = false): MeshBasicMaterial {
    const material = new MeshBasicMaterial({
      map,
      vertexColors,
      side: FrontSide,
      toneMapped: false,
      // Lines on the surface stay in front of it.
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    material.onBeforeCompile = (shader) => {
      if (this.uniforms.drapeMap.value === null) return;
      Object.assign(shader.uniforms, this.uniforms);
      shader.vertexShader = shader.vertexShader
        .replace("void main() {", VERTEX_HEAD)
        .replace("#include <project_vertex>", VERTEX_BODY);
      shader.fragmentShader = shader.fragmentShader
        .replace("void main() {", FRAGMENT_HEAD)
        .replace("#include <map_fragment>", FRAGMENT_BODY);
    };
    material.customProgramCacheKey = () => (this.uniforms.drapeMap.value === null ? "plain" : "draped");
    return material;
  }

  /** Until material.dispose(), which is the caller's. */
  adopt(material: MeshBasicMaterial): void {
    material.clippingPlanes = this.planes;
    this.materials.add(material);
    material.addEventListener("dispose", () => this.materials.delete(material));
  }

  setClip(planes: Plane[]): void {
    this.planes = planes;
    for (const material of this.materials) material.clippingPlanes = planes;
  }

  setDrape(drape: Drape | null): void {
    const before = this.uniforms.drapeMap.value;
    this.uniforms.drapeMap.value = drape?.texture ?? null;
    if (drape !== null) {
      this.uniforms.drapeMin.value.copy(drape.min);
      this.uniforms.drapeMax.value.copy(drape.max);
    }
    if ((before === null) !== (this.uniforms.drapeMap.value === null)) {
      for (const material of this.materials) material.needsUpdate = true;
    }
  }
}

export function matrixOf(rowMajor: readonly number[]): Matrix4 {
  const matrix = new Matrix4();
  // three.js keeps columns.
  return matrix.fromArray(rowMajor).transpose();
}

/** A texture that shows a decoded picture value by value. Its first row is v = 0. */
export function textureOf(bitmap: ImageBitmap): Texture {
  const texture = new Texture(bitmap);
  texture.flipY = false;
  texture.generateMipmaps = false;
  texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
