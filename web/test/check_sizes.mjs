// The bundles stay as small as they are: node check_sizes.mjs DIST. A budget is a little above what is needed; where one is exceeded, look with
// esbuild's metafile what has come in, and raise it only for something that is worth the longer wait for every page.
import { existsSync, readFileSync } from "node:fs";
import path from "node:path";

/** Bytes, minified and not compressed. The page of tours is read anew whenever one is opened. */
const MOST_BYTES = { "app.js": 1_320_000, "tour.js": 1_140_000 };
/** A budget that is this much too large says nothing any more. */
const MOST_SLACK = 0.1;

const [dist] = process.argv.slice(2);
const file = path.join(dist, "manifest.json");
if (!existsSync(file)) {
  console.log(`${file} is missing: run 'node build.mjs --out ${dist}' first`);
  process.exit(1);
}
const { bytes } = JSON.parse(readFileSync(file, "utf8"));
for (const [name, most] of Object.entries(MOST_BYTES)) {
  const size = bytes[name];
  const kilobytes = (value) => `${(value / 1000).toFixed(1)} kB`;
  if (size > most) {
    console.log(`${name} has ${kilobytes(size)}, and its budget in test/check_sizes.mjs is ${kilobytes(most)}`);
    process.exitCode = 1;
  } else if (!(size >= (1 - MOST_SLACK) * most)) {
    console.log(`${name} has ${kilobytes(size ?? 0)}, far below its budget of ${kilobytes(most)}: lower that`);
    process.exitCode = 1;
  }
}
