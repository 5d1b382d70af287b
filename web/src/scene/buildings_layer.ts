// The models of buildings: translucent roofs and walls with their edges, the chosen one and the one under the pointer brighter. They hide each other
// and are hidden by placed things, but are drawn over the surface, from which they differ by centimetres.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  type Material,
  Mesh,
  MeshBasicMaterial,
  type Plane,
  Scene,
} from "three";
import type { Vec3 } from "../base/vec.js";
import { cross, dot, norm, sub } from "../base/vec_math.js";
import { type BuildingSet, boxOfBuilding, type FaceKind } from "../state/buildings.js";
import type { Store } from "../state/store.js";
import { type SolidMesh, solidEdges, solidMesh } from "./building_shapes.js";
import { boxHolds } from "./clip.js";
import { meetsBox, nearestHit } from "./ray_mesh.js";
import { type Box, sceneFromEnu, type World } from "./world.js";

const FACES: Readonly<Record<FaceKind, Color>> = {
  ground: new Color(0x7d8894),
  wall: new Color(0xe4e8ec),
  roof: new Color(0xd0563a),
};
const COLOURS = { edge: 0xffffff, doubtful: 0xffb02e, selected: 0x4ad8ff } as const;
/** Darker away from it, so that slopes can be told apart. */
const LIGHT: Vec3 = [0.4, -0.55, 0.73];
const OPACITY = 0.4;

interface Shape {
  readonly id: number;
  readonly accepted: boolean;
  readonly box: Box;
  readonly mesh: SolidMesh;
  readonly edges: Float32Array;
}

function joined(arrays: readonly Float32Array[]): Float32Array {
  const all = new Float32Array(arrays.reduce((sum, array) => sum + array.length, 0));
  let at = 0;
  for (const array of arrays) {
    all.set(array, at);
    at += array.length;
  }
  return all;
}

function shadedColours({ positions, kinds }: SolidMesh): Float32Array {
  const colours = new Float32Array(positions.length);
  for (const [i, kind] of kinds.entries()) {
    const corner = (k: number): Vec3 => {
      const at = 9 * i + 3 * k;
      return [positions[at] ?? 0, positions[at + 1] ?? 0, positions[at + 2] ?? 0];
    };
    const normal = cross(sub(corner(1), corner(0)), sub(corner(2), corner(0)));
    const light = 0.75 + (0.25 * dot(normal, LIGHT)) / Math.max(norm(normal), 1e-12);
    const { r, g, b } = FACES[kind];
    for (let k = 0; k < 3; k += 1) colours.set([r * light, g * light, b * light], 9 * i + 3 * k);
  }
  return colours;
}

export class BuildingsLayer {
  readonly scene = new Scene();
  private readonly world: World;
  private shapes: readonly Shape[] = [];
  private planes: Plane[] = [];
  private readonly all = new Group();
  private readonly selected = new Group();
  private readonly hovered = new Group();
  private wanted = false;

  constructor(world: World) {
    this.world = world;
    this.scene.add(this.all, this.selected, this.hovered);
  }

  get visible(): boolean {
    return this.wanted && this.shapes.length > 0;
  }

  show(wanted: boolean): void {
    this.wanted = wanted;
  }

  setBuildings(set: BuildingSet | null): void {
    for (const group of [this.all, this.selected, this.hovered]) empty(group);
    const { anchor } = this.world;
    this.shapes = (set?.buildings ?? []).map((building) => {
      const { min, max } = boxOfBuilding(building);
      return {
        id: building.id,
        accepted: building.accepted,
        box: { min: sceneFromEnu(this.world, min), max: sceneFromEnu(this.world, max) },
        mesh: solidMesh(building.solid, anchor),
        edges: solidEdges(building.solid, anchor),
      };
    });
    if (this.shapes.length === 0) return;
    this.addFaces();
    this.addEdges(this.all, (shape) => shape.accepted, COLOURS.edge);
    this.addEdges(this.all, (shape) => !shape.accepted, COLOURS.doubtful);
  }

  /** Null: none. */
  highlight(selected: number | null, hovered: number | null): void {
    empty(this.selected);
    empty(this.hovered);
    const mark = (group: Group, id: number | null, colour: number, opacity: number): void => {
      const shape = this.shapes.find((one) => one.id === id);
      if (shape === undefined) return;
      const fill = new MeshBasicMaterial({ color: colour, transparent: true, opacity, depthWrite: false });
      fill.side = DoubleSide;
      const mesh = new Mesh(geometryOf(shape.mesh.positions), this.clipped(fill));
      mesh.renderOrder = 1;
      group.add(mesh);
      this.addEdges(group, (one) => one === shape, colour);
    };
    mark(this.selected, selected, COLOURS.selected, 0.4);
    if (hovered !== selected) mark(this.hovered, hovered, COLOURS.edge, 0.25);
  }

  setClip(planes: Plane[]): void {
    this.planes = planes;
    this.scene.traverse((object) => {
      if (object instanceof Mesh || object instanceof LineSegments) this.clipped(object.material);
    });
  }

  /** Id of the first model along the ray (scene coordinates, unit direction); null: none. With a clip box only what is inside counts. */
  pick(origin: Vec3, direction: Vec3, clip: Box | null): number | null {
    const inside =
      clip === null
        ? undefined
        : (t: number) =>
            boxHolds(clip, [origin[0] + t * direction[0], origin[1] + t * direction[1], origin[2] + t * direction[2]]);
    let nearest = Number.POSITIVE_INFINITY;
    let id: number | null = null;
    for (const { id: own, box, mesh } of this.shapes) {
      if (!meetsBox(box.min, box.max, origin, direction, nearest)) continue;
      const t = nearestHit({ positions: mesh.positions, indices: null }, origin, direction, nearest, inside);
      if (t < nearest) {
        nearest = t;
        id = own;
      }
    }
    return id;
  }

  dispose(): void {
    for (const group of [this.all, this.selected, this.hovered]) empty(group);
    this.shapes = [];
  }

  private addFaces(): void {
    const geometry = geometryOf(joined(this.shapes.map(({ mesh }) => mesh.positions)));
    const colours = joined(this.shapes.map(({ mesh }) => shadedColours(mesh)));
    geometry.setAttribute("color", new BufferAttribute(colours, 3));
    // Behind the edges, which lie on them.
    const behind = { side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
    // First only their depth, so that of several faces one behind the other the nearest alone is seen through.
    const depth = new Mesh(geometry, this.clipped(new MeshBasicMaterial({ ...behind, colorWrite: false })));
    depth.renderOrder = -1;
    const faces = new Mesh(
      geometry,
      this.clipped(
        new MeshBasicMaterial({
          ...behind,
          vertexColors: true,
          transparent: true,
          opacity: OPACITY,
          depthWrite: false,
          toneMapped: false,
        }),
      ),
    );
    this.all.add(depth, faces);
  }

  private addEdges(group: Group, which: (shape: Shape) => boolean, colour: number): void {
    const positions = joined(this.shapes.filter(which).map(({ edges }) => edges));
    if (positions.length === 0) return;
    const material = this.clipped(new LineBasicMaterial({ color: colour, toneMapped: false }));
    group.add(new LineSegments(geometryOf(positions), material));
  }

  private clipped<T extends Material>(material: T): T {
    material.clippingPlanes = this.planes;
    return material;
  }
}

function geometryOf(positions: Float32Array): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  return geometry;
}

function empty(group: Group): void {
  for (const child of [...group.children]) {
    if (child instanceof Mesh || child instanceof LineSegments) {
      child.geometry.dispose();
      child.material.dispose();
    }
    child.removeFromParent();
  }
}

/** Keeps the layer in step with the store. Returns the function that ends it. */
export function watchBuildings(store: Store, layer: BuildingsLayer, invalidate: () => void): () => void {
  const mark = (): void => {
    const { selectedBuilding, hoverBuilding } = store.get();
    layer.highlight(selectedBuilding, hoverBuilding);
    invalidate();
  };
  const ends = [
    store.subscribe(
      ({ buildings }) => buildings.set,
      (set) => {
        layer.setBuildings(set);
        mark();
      },
    ),
    store.subscribe(
      ({ layers }) => layers.buildings,
      (on) => {
        layer.show(on);
        invalidate();
      },
    ),
    store.subscribe(({ selectedBuilding }) => selectedBuilding, mark),
    store.subscribe(({ hoverBuilding }) => hoverBuilding, mark),
  ];
  const { buildings, layers } = store.get();
  layer.setBuildings(buildings.set);
  layer.show(layers.buildings);
  mark();
  return () => {
    for (const end of ends) end();
  };
}
