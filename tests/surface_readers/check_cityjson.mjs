// Checks a CityJSON file against the specification of version 2.0 and reads its solids with cityjson-threejs-loader, the CityJSON group's loader.
//   node check_cityjson.mjs FILE
// Prints {buildings, vertices, triangles, crs, extent, solids}; solids: for each its building, lod, faces, volume and areas by the type of surface.
// Exit status 1, with a message that names the place, when something is wrong.
import { readFile } from 'node:fs/promises';
import { Vector3 } from 'three';
// Not the loader's front page, which is written for bundlers and draws with WebGL.
import { TriangleParser } from 'cityjson-threejs-loader/src/parsers/geometry/TriangleParser.js';

const kSurfaces = ['GroundSurface', 'WallSurface', 'RoofSurface', 'OuterCeilingSurface', 'OuterFloorSurface', 'ClosureSurface'];
const kCrs = /^https?:\/\/www\.opengis\.net\/def\/crs\/[^/]+\/[^/]+\/[^/]+$/;
const kPlanarM = 0.01;
const kNearM = 0.001;
const kNearestM = 0.0009;  // of corners: 1 mm in the survey is a little less on the map
const kSlimM2 = 0.01;  // rounding turns faces below it

function need(condition, message) {
  if (!condition) throw new Error(message);
}

function needNumbers(list, count, place) {
  need(Array.isArray(list) && list.length === count && list.every(Number.isFinite), `${place} is not a list of ${count} numbers`);
}

// What has to be right before the vertices can be used.
function checkFrame(document) {
  need(document.type === 'CityJSON', 'type is not "CityJSON"');
  need(document.version === '2.0', `version is ${JSON.stringify(document.version)}`);
  need(typeof document.transform === 'object', 'transform is missing');
  needNumbers(document.transform.scale, 3, 'transform.scale');
  needNumbers(document.transform.translate, 3, 'transform.translate');
  need(Array.isArray(document.vertices), 'vertices is no list');
  const seen = new Set();
  document.vertices.forEach((vertex, i) => {
    need(Array.isArray(vertex) && vertex.length === 3 && vertex.every(Number.isSafeInteger), `vertices[${i}] is not three whole numbers`);
    need(!seen.has(String(vertex)), `vertices[${i}] is there twice`);
    seen.add(String(vertex));
  });
  need(document.CityObjects !== null && typeof document.CityObjects === 'object' && !Array.isArray(document.CityObjects), 'CityObjects is no object');
  const { metadata = {} } = document;
  if ('referenceSystem' in metadata) need(kCrs.test(metadata.referenceSystem), `referenceSystem is ${JSON.stringify(metadata.referenceSystem)}`);
}

function checkExtent(document, points) {
  const { geographicalExtent: extent } = document.metadata ?? {};
  if (points.length === 0) return need(extent === undefined, 'geographicalExtent without vertices');
  needNumbers(extent, 6, 'metadata.geographicalExtent');
  ['x', 'y', 'z'].forEach((axis, i) => {
    const values = points.map((point) => point[axis]);
    // Not Math.min(...values), which fails for long lists.
    const [min, max] = values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
    need(Math.abs(extent[i] - min) <= kNearM && Math.abs(extent[3 + i] - max) <= kNearM, `geographicalExtent is wrong in ${axis}: ${min} to ${max}`);
  });
}

// Newell's normal, as long as twice the area; relative to the first corner, for coordinates of maps are large.
function normalOf(corners) {
  const sum = new Vector3();
  for (let i = 1; i + 1 < corners.length; ++i) {
    const a = corners[i].clone().sub(corners[0]);
    const b = corners[i + 1].clone().sub(corners[0]);
    sum.add(a.cross(b));
  }
  return sum;
}

function checkRing(ring, points, used, place) {
  need(Array.isArray(ring) && ring.length >= 3, `${place} has fewer than three corners`);
  ring.forEach((index, i) => {
    need(Number.isSafeInteger(index) && index >= 0 && index < points.length, `${place}[${i}] is no vertex`);
    used.add(index);
    const next = ring[(i + 1) % ring.length];
    need(next !== index, `${place} repeats a corner`);
    need(points[index].distanceTo(points[next]) >= kNearestM, `${place} has an edge shorter than 1 mm`);
  });
  need(new Set(ring).size === ring.length, `${place} touches itself`);
}

// The faces of a Solid with their normals; throws unless the shell is closed, planar and its semantics fit.
function checkSolid(geometry, points, used, place) {
  need(geometry.type === 'Solid', `${place} is ${geometry.type}`);
  need(typeof geometry.lod === 'string' && /^[0-3](\.[0-3])?$/.test(geometry.lod), `${place} has the lod ${JSON.stringify(geometry.lod)}`);
  need(Array.isArray(geometry.boundaries) && geometry.boundaries.length === 1, `${place} has not one shell`);
  const { surfaces, values } = geometry.semantics ?? {};
  need(Array.isArray(surfaces) && surfaces.every(({ type }) => kSurfaces.includes(type)), `${place} has an unknown surface`);
  const [shell] = geometry.boundaries;
  need(Array.isArray(values) && values.length === 1 && values[0].length === shell.length, `${place}: semantics do not fit the boundaries`);
  const edges = new Set();
  const faces = shell.map((rings, f) => {
    const here = `${place} face ${f}`;
    need(Array.isArray(rings) && rings.length >= 1, `${here} has no ring`);
    rings.forEach((ring, r) => {
      checkRing(ring, points, used, `${here} ring ${r}`);
      ring.forEach((from, i) => {
        const edge = `${from} ${ring[(i + 1) % ring.length]}`;
        need(!edges.has(edge), `${here}: edge ${edge} is used twice in one direction`);
        edges.add(edge);
      });
    });
    const normals = rings.map((ring) => normalOf(ring.map((index) => points[index])));
    const normal = normals[0].clone().normalize();
    need(normals[0].length() > 0, `${here} has no area`);
    normals.slice(1).forEach((hole) => need(hole.dot(normal) < 0, `${here} has a hole that turns like its outer ring`));
    rings.flat().forEach((index) => {
      const away = Math.abs(points[index].clone().sub(points[rings[0][0]]).dot(normal));
      need(away <= kPlanarM, `${here} is not planar: ${away} m`);
    });
    need(Number.isSafeInteger(values[0][f]) && surfaces[values[0][f]], `${here} has no surface`);
    const { type } = surfaces[values[0][f]];
    const area = normals.reduce((sum, one, r) => sum + (r === 0 ? 0.5 : -0.5) * one.length(), 0);
    if (area < kSlimM2) return { type, normal, area };
    if (type === 'GroundSurface') need(normal.z < -0.5, `${here} is ground but does not face down`);
    if (type === 'RoofSurface') need(normal.z > 0.01, `${here} is a roof but does not face up`);
    if (type === 'WallSurface') need(Math.abs(normal.z) < 0.05, `${here} is a wall but not upright`);
    return { type, normal, area };
  });
  for (const edge of edges) {
    const [from, to] = edge.split(' ');
    need(edges.has(`${to} ${from}`), `${place} is open at edge ${edge}`);
  }
  return faces;
}

// Triangles as the loader makes them.
function triangulate(document, points, id, number) {
  const parser = new TriangleParser(document, Object.keys(document.CityObjects), { Building: 0 }, points.map(({ x, y, z }) => [x, y, z]));
  parser.parseGeometry(document.CityObjects[id].geometry[number], id, number);
  const { vertexIds, boundaryIds } = parser.geomData;
  const triangles = [];
  for (let i = 0; i < vertexIds.length; i += 3) {
    triangles.push({ face: boundaryIds[i], corners: vertexIds.slice(i, i + 3).map((index) => points[index]) });
  }
  return triangles;
}

function measure(faces, triangles, place) {
  const areas = faces.map(() => 0);
  let volume = 0;
  const apex = triangles[0].corners[0];
  for (const { face, corners } of triangles) {
    const area = normalOf(corners);
    areas[face] += 0.5 * area.length();
    const [a, b, c] = corners.map((corner) => corner.clone().sub(apex));
    // The loader turns all triangles of a face alike, but not always to the outside.
    volume += (Math.sign(area.dot(faces[face].normal)) * a.dot(b.cross(c))) / 6;
  }
  faces.forEach(({ area }, f) => {
    need(Math.abs(area - areas[f]) <= 0.001 + 0.001 * area, `${place} face ${f}: ${area} m2, its triangles ${areas[f]} m2`);
  });
  need(volume > 0, `${place} is inside out`);
  const byType = {};
  faces.forEach(({ type, area }) => (byType[type] = (byType[type] ?? 0) + area));
  return { faces: faces.length, volume, areas: byType };
}

async function read(file) {
  const document = JSON.parse(await readFile(file, 'utf8'));
  checkFrame(document);
  const { scale, translate } = document.transform;
  const points = document.vertices.map((vertex) => new Vector3(...vertex.map((step, axis) => step * scale[axis] + translate[axis])));
  checkExtent(document, points);
  const used = new Set();
  const solids = [];
  let triangles = 0;
  for (const [id, object] of Object.entries(document.CityObjects)) {
    need(object.type === 'Building', `${id} is ${object.type}`);
    need(object.attributes !== null && typeof object.attributes === 'object', `${id} has no attributes`);
    for (const [name, value] of Object.entries(object.attributes)) {
      if (name.endsWith('_sigma')) need(Number.isFinite(value) && value >= 0, `${id}.${name} is ${value}`);
    }
    need(Array.isArray(object.geometry), `${id} has no list of geometries`);
    object.geometry.forEach((geometry, number) => {
      const place = `${id} lod ${geometry.lod}`;
      const faces = checkSolid(geometry, points, used, place);
      const made = triangulate(document, points, id, number);
      triangles += made.length;
      solids.push({ building: id, lod: geometry.lod, ...measure(faces, made, place) });
    });
    need(new Set(object.geometry.map(({ lod }) => lod)).size === object.geometry.length, `${id} has two geometries of one lod`);
  }
  need(used.size === points.length, `${points.length - used.size} vertices are not used`);
  const { referenceSystem: crs = '', geographicalExtent: extent = null } = document.metadata ?? {};
  return { buildings: Object.keys(document.CityObjects).length, vertices: points.length, triangles, crs, extent, solids };
}

if (process.argv.length !== 3) {
  console.error('usage: node check_cityjson.mjs FILE');
  process.exit(2);
}
try {
  console.log(JSON.stringify(await read(process.argv[2])));
} catch (error) {
  console.error(`${process.argv[2]}: ${error.message}`);
  process.exit(1);
}
