// How models look: base colours as display values under one soft light, so that the sides of a plain box can be told apart; how they reflect is left
// out, and they stand still. The loader's materials are replaced.
import {
  Box3,
  BufferAttribute,
  type BufferGeometry,
  Camera,
  Color,
  HemisphereLight,
  Light,
  Line,
  LineBasicMaterial,
  type Material,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  NoColorSpace,
  type Object3D,
  Points,
  PointsMaterial,
  SkinnedMesh,
  type Texture,
  Vector3,
} from "three";
import type { Model } from "./model.js";

/** A surface that turns to the light shows its own colour, one that turns away half of it. The light is that of the models of buildings. */
export function modelLight(): HemisphereLight {
  const light = new HemisphereLight(0xffffff, 0x808080, Math.PI);
  light.position.set(0.4, -0.55, 0.73);
  return light;
}

/** Takes what the loader made. Throws an Error for the user. */
export function dressModel(object: Object3D): Model {
  object.updateMatrixWorld(true);
  const shapes: (Mesh | Line | Points)[] = [];
  const aside: Object3D[] = [];
  object.traverse((child) => {
    if (child instanceof Light || child instanceof Camera) aside.push(child);
    if (child instanceof Mesh || child instanceof Line || child instanceof Points) shapes.push(child);
  });
  for (const child of aside) child.removeFromParent();
  const looks = new Map<Material, Material>();
  const geometries = new Set<BufferGeometry>();
  const free = () => {
    for (const material of looks.values()) {
      mapOf(material)?.dispose();
      material.dispose();
    }
    for (const geometry of geometries) geometry.dispose();
  };
  try {
    for (const shape of shapes) {
      const given: Material | Material[] = shape.material;
      const first = Array.isArray(given) ? given[0] : given;
      if (first === undefined) continue;
      const look = looks.get(first) ?? plainMaterial(shape, first);
      looks.set(first, look);
      if (first !== look) first.dispose();
      shape.material = look;
      const { geometry } = shape instanceof Mesh ? standStill(shape) : shape;
      if (geometries.has(geometry)) continue;
      geometries.add(geometry);
      prepare(geometry);
    }
    if (shapes.length === 0) throw new Error("there is nothing to see in it");
    const { min, max } = new Box3().setFromObject(object, true);
    return { object, box: { min: [min.x, min.y, min.z], max: [max.x, max.y, max.z] }, dispose: free };
  } catch (error) {
    free();
    throw error;
  }
}

function mapOf(material: Material): Texture | null {
  return "map" in material && isTexture(material.map) ? material.map : null;
}

function isTexture(value: unknown): value is Texture {
  return typeof value === "object" && value !== null && "isTexture" in value;
}

function plainMaterial(shape: Mesh | Line | Points, given: Material): Material {
  const map = mapOf(given);
  // Display values pass through unchanged.
  if (map !== null) map.colorSpace = NoColorSpace;
  const { vertexColors, transparent, opacity, alphaTest, side, depthWrite } = given;
  const color =
    "color" in given && given.color instanceof Color ? given.color.clone().convertLinearToSRGB() : new Color(1, 1, 1);
  const common = { color, vertexColors, transparent, opacity, alphaTest, side, depthWrite, toneMapped: false };
  if (shape instanceof Points) return new PointsMaterial({ ...common, map, size: 3, sizeAttenuation: false });
  if (shape instanceof Line) return new LineBasicMaterial(common);
  if (given instanceof MeshBasicMaterial) return new MeshBasicMaterial({ ...common, map });
  return new MeshLambertMaterial({ ...common, map, flatShading: shape.geometry.getAttribute("normal") === undefined });
}

/** Bones and morphs as they are at rest become the shape. Returns what is in the place of the mesh then. */
function standStill(mesh: Mesh): Mesh {
  const { geometry } = mesh;
  const skinned = mesh instanceof SkinnedMesh;
  if (!skinned && Object.keys(geometry.morphAttributes).length === 0) return mesh;
  if (skinned) mesh.skeleton.update();
  const still = geometry.clone();
  const count = still.getAttribute("position").count;
  const positions = new Float32Array(3 * count);
  const at = new Vector3();
  for (let i = 0; i < count; i += 1) mesh.getVertexPosition(i, at).toArray(positions, 3 * i);
  still.setAttribute("position", new BufferAttribute(positions, 3));
  for (const name of ["skinIndex", "skinWeight"]) still.deleteAttribute(name);
  still.morphAttributes = {};
  if (still.getAttribute("normal") !== undefined) still.computeVertexNormals();
  const copy = new Mesh(still, mesh.material);
  copy.matrix.copy(mesh.matrix);
  copy.matrix.decompose(copy.position, copy.quaternion, copy.scale);
  for (const child of [...mesh.children]) copy.add(child);
  mesh.parent?.add(copy);
  mesh.removeFromParent();
  return copy;
}

function prepare(geometry: BufferGeometry): void {
  const position = geometry.getAttribute("position");
  if (position === undefined) throw new Error("a part of it has no positions");
  for (let i = 0; i < position.count; i += 1) {
    if (!Number.isFinite(position.getX(i) + position.getY(i) + position.getZ(i)))
      throw new Error("a position in it is not a number");
  }
  // What the file says of its size need not be true.
  geometry.boundingBox = null;
  geometry.boundingSphere = null;
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  const color = geometry.getAttribute("color");
  if (color === undefined) return;
  const shown = new Float32Array(color.count * color.itemSize);
  const linear = new Color();
  for (let i = 0; i < color.count; i += 1) {
    linear
      .setRGB(color.getX(i), color.getY(i), color.getZ(i))
      .convertLinearToSRGB()
      .toArray(shown, color.itemSize * i);
    if (color.itemSize === 4) shown[4 * i + 3] = color.getW(i);
  }
  geometry.setAttribute("color", new BufferAttribute(shown, color.itemSize));
}
