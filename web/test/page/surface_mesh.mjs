// The surface as triangles, read from its tiles without any code of the page: for distances of ways from it.
import { readFileSync } from "node:fs";
import path from "node:path";

const CELL_M = 2;
const READERS = {
  5121: [1, "readUInt8"],
  5123: [2, "readUInt16LE"],
  5125: [4, "readUInt32LE"],
  5126: [4, "readFloatLE"],
};
const WIDTHS = { SCALAR: 1, VEC3: 3 };

/** The bytes of a file of an exported tour, by its name below data/. */
export function packedFile(folder, name) {
  const script = readFileSync(path.join(folder, "data", `${name}.js`), "utf8");
  return Buffer.from(script.slice(script.indexOf('"', script.indexOf(",")) + 1, script.lastIndexOf('"')), "base64");
}

/** Of the finest tiles that there are. `read`: the bytes of a file of the tileset by its name. */
export function readSurface(read) {
  const triangles = [];
  const visit = (tile) => {
    const children = tile.children ?? [];
    for (const child of children) visit(child);
    if (children.length === 0 && tile.content) addGlb(read(tile.content.uri), triangles);
  };
  visit(JSON.parse(read("tileset.json").toString()).root);
  return new Surface(triangles);
}

/** Positions in ENU: below the root's transform the tiles have it, but for glTF's axes. */
function addGlb(bytes, triangles) {
  const length = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.toString("utf8", 20, 20 + length));
  const binary = bytes.subarray(20 + length + 8);
  const values = (index) => {
    const { bufferView, byteOffset = 0, componentType, count, type } = json.accessors[index];
    const view = json.bufferViews[bufferView];
    const [size, read] = READERS[componentType];
    const width = WIDTHS[type];
    const stride = view.byteStride ?? size * width;
    const first = (view.byteOffset ?? 0) + byteOffset;
    return Array.from({ length: count * width }, (_, k) =>
      binary[read](first + Math.floor(k / width) * stride + (k % width) * size),
    );
  };
  for (const { mesh, translation = [0, 0, 0], matrix, rotation, scale, children } of json.nodes) {
    if (matrix || rotation || scale || children) throw new Error("this check knows plain nodes only");
    for (const { attributes, indices } of json.meshes[mesh].primitives) {
      const p = values(attributes.POSITION);
      const corner = (i) => {
        const [x, y, z] = [0, 1, 2].map((axis) => p[3 * i + axis] + translation[axis]);
        return [x, -z, y];
      };
      const list = indices === undefined ? p.slice(0, p.length / 3).map((_, i) => i) : values(indices);
      for (let k = 0; k + 2 < list.length; k += 3) triangles.push([0, 1, 2].map((j) => corner(list[k + j])));
    }
  }
}

const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

function toEdge(p, a, b) {
  const [ab, ap] = [sub(b, a), sub(p, a)];
  const square = dot(ab, ab);
  const t = square > 0 ? Math.min(1, Math.max(0, dot(ap, ab) / square)) : 0;
  return Math.hypot(...sub(ap, [t * ab[0], t * ab[1], t * ab[2]]));
}

export function distanceToTriangle(p, [a, b, c]) {
  const n = cross(sub(b, a), sub(c, a));
  const length = Math.hypot(...n);
  const inside = (u, v) => dot(cross(sub(v, u), sub(p, u)), n) >= 0;
  if (length > 0 && inside(a, b) && inside(b, c) && inside(c, a)) return Math.abs(dot(sub(p, a), n)) / length;
  return Math.min(toEdge(p, a, b), toEdge(p, b, c), toEdge(p, c, a));
}

class Surface {
  constructor(triangles) {
    this.triangles = triangles;
    this.cells = new Map();
    for (const [k, triangle] of triangles.entries()) {
      const [x, y] = [0, 1].map((i) => triangle.map((corner) => Math.floor(corner[i] / CELL_M)));
      for (let i = Math.min(...x); i <= Math.max(...x); i += 1) {
        for (let j = Math.min(...y); j <= Math.max(...y); j += 1) {
          const key = `${i} ${j}`;
          const cell = this.cells.get(key);
          if (cell === undefined) this.cells.set(key, [k]);
          else cell.push(k);
        }
      }
    }
  }

  /** Of a point from the nearest triangle; `most` where there is none that near. */
  distance(p, most = 3) {
    let nearest = most;
    const [x, y] = [0, 1].map((i) => [Math.floor((p[i] - most) / CELL_M), Math.floor((p[i] + most) / CELL_M)]);
    for (let i = x[0]; i <= x[1]; i += 1) {
      for (let j = y[0]; j <= y[1]; j += 1) {
        for (const k of this.cells.get(`${i} ${j}`) ?? []) {
          nearest = Math.min(nearest, distanceToTriangle(p, this.triangles[k]));
        }
      }
    }
    return nearest;
  }

  /** Of the nearest point of a straight line, at every tenth of a metre. */
  alongLine(from, to) {
    const parts = Math.max(1, Math.ceil(Math.hypot(...sub(to, from)) * 10));
    const at = (k) => from.map((value, i) => value + ((to[i] - value) * k) / parts);
    return Math.min(...Array.from({ length: parts + 1 }, (_, k) => this.distance(at(k))));
  }
}
