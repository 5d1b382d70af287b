// Loads all tiles of a tileset with 3d-tiles-renderer, the library of NASA that shows 3D Tiles with three.js, without a browser: nothing is drawn.
//   node check_tiles.mjs TILESET.json
// Prints {tiles, visible, triangles, images, ecef_min, ecef_max, errors}: tiles that were loaded; tiles that would be drawn from nearby, their
// triangles and the box around their vertices; sizes of the images. Exit status 1 when a tile could not be loaded.
import { createReadStream } from 'node:fs';
import { stat } from 'node:fs/promises';
import http from 'node:http';
import path from 'node:path';

const kDeadlineMs = 60000;
const kPollMs = 5;
const kLocalM = 1e6;
const kRoot = '/set/';  // of the addresses of the tiles

// Width and height of a JPEG, from the head of its frame.
function jpegSize(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (view.getUint16(0) !== 0xffd8) throw new Error('an image is no JPEG');
  for (let at = 2; at + 9 <= view.byteLength; at += 2 + view.getUint16(at + 2)) {
    const marker = view.getUint16(at);
    if (marker < 0xff00) break;
    const isFrame = marker >= 0xffc0 && marker <= 0xffcf && marker !== 0xffc4 && marker !== 0xffc8 && marker !== 0xffcc;
    if (isFrame) return { width: view.getUint16(at + 7), height: view.getUint16(at + 5) };
  }
  throw new Error('a JPEG without a frame');
}

// What the library expects of a browser.
const images = [];
const errors = [];
class ImageBitmap {
  constructor(size) {
    Object.assign(this, size);
  }
  close() {}
}
globalThis.self = globalThis;
globalThis.ImageBitmap = ImageBitmap;
globalThis.createImageBitmap = async (blob) => {
  try {
    const size = jpegSize(new Uint8Array(await blob.arrayBuffer()));
    images.push(size);
    return new ImageBitmap(size);
  } catch (error) {
    errors.push(error.message);  // three.js goes on without the texture
    throw error;
  }
};
globalThis.requestAnimationFrame = (run) => setTimeout(run, 0);
globalThis.cancelAnimationFrame = (handle) => clearTimeout(handle);
globalThis.ProgressEvent = globalThis.ProgressEvent ?? class extends Event {};

// Serves the files below the folder to this process only.
async function serve(folder) {
  const server = http.createServer(async (request, response) => {
    const asked = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
    const file = path.join(folder, asked.slice(kRoot.length));
    const found = asked.startsWith(kRoot) && file.startsWith(folder + path.sep) && (await stat(file).catch(() => null));
    if (!found || !found.isFile()) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { 'content-length': found.size });
    createReadStream(file).pipe(response);
  });
  await new Promise((resolve, reject) => server.once('error', reject).listen(0, '127.0.0.1', resolve));
  return server;
}

async function load(file) {
  const folder = path.dirname(path.resolve(file));
  const server = await serve(folder);
  const address = `http://127.0.0.1:${server.address().port}${kRoot}`;
  globalThis.window = { location: { href: address } };
  // Imported late: they look at the globals above.
  const { Box3, PerspectiveCamera, Sphere, Vector3 } = await import('three');
  const { TilesRenderer } = await import('3d-tiles-renderer/three');

  const warn = console.warn;
  // A note of the library about every tileset of version 1.1.
  console.warn = (...words) => String(words[0]).includes('limited support') || warn(...words);
  const tiles = new TilesRenderer(address + encodeURIComponent(path.basename(file)));
  tiles.errorTarget = 0;
  tiles.lruCache.maxSize = tiles.lruCache.minSize = 1e6;
  tiles.lruCache.maxBytesSize = tiles.lruCache.minBytesSize = 1e12;
  let loaded = 0;
  tiles.addEventListener('load-model', () => ++loaded);
  tiles.addEventListener('load-error', ({ url, error }) => errors.push(`${url}: ${error?.message ?? error}`));

  const camera = new PerspectiveCamera(60, 1, 1, 1e8);
  tiles.setCamera(camera);
  tiles.setResolution(camera, 4096, 4096);
  const sphere = new Sphere();
  let placed = false;
  const pause = () => new Promise((resolve) => setTimeout(resolve, kPollMs));
  for (const end = Date.now() + kDeadlineMs; ; await pause()) {
    if (Date.now() > end) errors.push(`not loaded within ${kDeadlineMs / 1000} s`);
    if (!placed && tiles.getBoundingSphere(sphere)) {
      // From above, far enough to have the whole set in the view. A set that is not placed on Earth is near the origin, with z up.
      const onEarth = sphere.center.length() > kLocalM;
      const up = onEarth ? sphere.center.clone().normalize() : new Vector3(0, 0, 1);
      camera.position.copy(sphere.center).addScaledVector(up, 3 * sphere.radius);
      camera.up.set(0, onEarth ? 0 : 1, onEarth ? 1 : 0);
      camera.lookAt(sphere.center);
      camera.updateMatrixWorld(true);
      placed = true;
    }
    tiles.update();
    const busy = tiles.stats.downloading + tiles.stats.parsing > 0 || tiles.isLoading || tiles.processNodeQueue.running;
    if (errors.length > 0 || (placed && !busy && tiles.visibleTiles.size > 0)) break;
  }
  server.closeAllConnections?.();
  server.close();

  const box = new Box3();
  const point = new Vector3();
  let triangles = 0;
  for (const tile of tiles.visibleTiles) {
    tile.cached.scene.updateMatrixWorld(true);
    tile.cached.scene.traverse((object) => {
      if (!object.isMesh) return;
      const { position } = object.geometry.attributes;
      triangles += (object.geometry.index?.count ?? position.count) / 3;
      for (let i = 0; i < position.count; ++i) box.expandByPoint(point.fromBufferAttribute(position, i).applyMatrix4(object.matrixWorld));
    });
  }
  return { tiles: loaded, visible: tiles.visibleTiles.size, triangles, images, ecef_min: box.min.toArray(), ecef_max: box.max.toArray(), errors };
}

if (process.argv.length !== 3) {
  console.error('usage: node check_tiles.mjs TILESET.json');
  process.exit(2);
}
const result = await load(process.argv[2]);
console.log(JSON.stringify(result));
process.exit(result.errors.length > 0 ? 1 : 0);
