// Reads an uncompressed LAS file with the copc package.
//   node check_las.mjs FILE
// Prints {count, min, max, first, classes, format, wkt}; exit status 1 when the file cannot be read or contradicts itself.
import { readFile } from 'node:fs/promises';
import copc from 'copc';

const { Las } = copc;
const kWktRecord = 2112;

async function read(file) {
  const bytes = new Uint8Array(await readFile(file));
  const header = Las.Header.parse(bytes.slice(0, Las.Constants.minHeaderLength));
  const getter = async (begin, end) => bytes.slice(begin, end);
  const records = await Las.Vlr.walk(getter, header);
  const projection = Las.Vlr.find(records, 'LASF_Projection', kWktRecord);
  const wkt = projection ? new TextDecoder().decode(await Las.Vlr.fetch(getter, projection)).replace(/\0+$/, '') : '';
  const end = header.pointDataOffset + header.pointCount * header.pointDataRecordLength;
  if (end > bytes.length) throw new Error(`${header.pointCount} points do not fit into ${bytes.length} bytes`);

  const view = Las.View.create(bytes.slice(header.pointDataOffset, end), header);
  const get = Object.fromEntries(['X', 'Y', 'Z', 'Red', 'Green', 'Blue', 'Classification'].map((name) => [name, view.getter(name)]));
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  const classes = {};
  for (let i = 0; i < view.pointCount; ++i) {
    ['X', 'Y', 'Z'].forEach((name, axis) => {
      const value = get[name](i);
      min[axis] = Math.min(min[axis], value);
      max[axis] = Math.max(max[axis], value);
    });
    const number = get.Classification(i);
    classes[number] = (classes[number] ?? 0) + 1;
  }
  for (let axis = 0; axis < 3 && view.pointCount > 0; ++axis) {
    const slack = 1.01 * header.scale[axis];
    if (Math.abs(min[axis] - header.min[axis]) > slack || Math.abs(max[axis] - header.max[axis]) > slack) {
      throw new Error(`axis ${axis} is ${min[axis]} to ${max[axis]}, the header says ${header.min[axis]} to ${header.max[axis]}`);
    }
  }
  const first = view.pointCount > 0 ? Object.fromEntries(Object.entries(get).map(([name, of]) => [name, of(0)])) : null;
  return { count: view.pointCount, min, max, first, classes, format: header.pointDataRecordFormat, wkt };
}

if (process.argv.length !== 3) {
  console.error('usage: node check_las.mjs FILE');
  process.exit(2);
}
try {
  console.log(JSON.stringify(await read(process.argv[2])));
} catch (error) {
  console.error(`${process.argv[2]}: ${error.message}`);
  process.exit(1);
}
