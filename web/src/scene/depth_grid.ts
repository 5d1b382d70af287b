// An exact frame as a surface: its depth image as a grid of triangles, cut where the depth jumps, so that the frame can be seen from beside its own
// camera. Holes show what is behind, the mesh.

export interface GridInput {
  /** Pixels of the colour. */
  readonly width: number;
  readonly height: number;
  /** Depth pixel (i, j) belongs to colour pixel (2i, 2j). */
  readonly depthWidth: number;
  readonly depthHeight: number;
  /** z along the optical axis in metres, NaN: no surface. */
  readonly depthM: Float32Array;
  /** Exactly one of the two is not null. */
  readonly fovyDeg: number | null;
  readonly orthoHeightM: number | null;
}

export interface DepthGrid {
  /** x right, y down, z ahead of the frame's camera, metres. */
  readonly positions: Float32Array;
  /** From the upper left corner of the picture. */
  readonly uvs: Float32Array;
  /** From the top row down, so that near things are drawn over far ones in the usual views. */
  readonly indices: Uint32Array;
}

const MOST_VERTICES = 40_000;
/** A cell is cut when its depth changes by more than this many times its width: surfaces seen at less than about 5 degrees. */
const STEEPEST = 12;

/** 0, step, 2 step, ... and always the last. */
function samples(count: number, step: number): number[] {
  const places: number[] = [];
  for (let i = 0; i < count - 1; i += step) places.push(i);
  if (count > 0) places.push(count - 1);
  return places;
}

export function makeDepthGrid(input: GridInput, mostVertices = MOST_VERTICES): DepthGrid {
  const { width, height, depthWidth, depthHeight, depthM } = input;
  const empty = { positions: new Float32Array(0), uvs: new Float32Array(0), indices: new Uint32Array(0) };
  if (depthM.length < depthWidth * depthHeight || depthWidth < 2 || depthHeight < 2 || width < 1 || height < 1)
    return empty;
  let step = 1;
  while (Math.ceil(depthWidth / step) * Math.ceil(depthHeight / step) > mostVertices) step += 1;
  const columns = samples(depthWidth, step);
  const rows = samples(depthHeight, step);
  const count = columns.length * rows.length;
  const positions = new Float32Array(3 * count);
  const uvs = new Float32Array(2 * count);
  // Size of a colour pixel: at distance 1, or in metres.
  const pixel =
    input.orthoHeightM !== null
      ? input.orthoHeightM / height
      : (2 * Math.tan(((input.fovyDeg ?? 60) * Math.PI) / 360)) / height;
  const perspective = input.orthoHeightM === null;
  let at = 0;
  for (const j of rows) {
    const y = 2 * j + 0.5;
    for (const i of columns) {
      const x = 2 * i + 0.5;
      const z = depthM[j * depthWidth + i] ?? Number.NaN;
      const size = perspective ? pixel * z : pixel;
      positions[3 * at] = (x - width / 2) * size;
      positions[3 * at + 1] = (y - height / 2) * size;
      positions[3 * at + 2] = z;
      uvs[2 * at] = x / width;
      uvs[2 * at + 1] = y / height;
      at += 1;
    }
  }
  const depth = (vertex: number) => positions[3 * vertex + 2] ?? Number.NaN;
  const whole = (a: number, b: number, c: number): boolean => {
    const [za, zb, zc] = [depth(a), depth(b), depth(c)];
    const near = Math.min(za, zb, zc);
    const limit = STEEPEST * 2 * step * (perspective ? pixel * near : pixel);
    // False also when one of them is NaN.
    return near > 0 && Math.max(za, zb, zc) - near <= limit;
  };
  const indices = new Uint32Array(6 * Math.max(0, columns.length - 1) * Math.max(0, rows.length - 1));
  let used = 0;
  const put = (a: number, b: number, c: number): void => {
    if (!whole(a, b, c)) return;
    indices[used] = a;
    indices[used + 1] = b;
    indices[used + 2] = c;
    used += 3;
  };
  for (let row = 0; row + 1 < rows.length; row += 1) {
    for (let column = 0; column + 1 < columns.length; column += 1) {
      const a = row * columns.length + column;
      const [b, c, d] = [a + 1, a + columns.length, a + columns.length + 1];
      // Along the diagonal whose ends are alike, so that an edge of a roof cuts as little as possible.
      if (Math.abs(depth(a) - depth(d)) <= Math.abs(depth(b) - depth(c))) {
        put(a, d, b);
        put(a, c, d);
      } else {
        put(a, c, b);
        put(b, c, d);
      }
    }
  }
  // Vertices without a surface belong to no triangle; NaN in them would spoil bounding boxes.
  for (let i = 0; i < positions.length; i += 1) if (!Number.isFinite(positions[i] ?? 0)) positions[i] = 0;
  return { positions, uvs, indices: indices.slice(0, used) };
}
