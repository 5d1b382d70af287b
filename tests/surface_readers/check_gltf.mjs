// Validates glTF files with Khronos' validator.
//   node check_gltf.mjs FILE...
// Prints {files, errors, warnings, messages}; exit status 1 when a file has an error.
import { readFile } from 'node:fs/promises';
import validator from 'gltf-validator';

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node check_gltf.mjs FILE...');
  process.exit(2);
}

const kSeverities = ['error', 'warning', 'information', 'hint'];
const kShown = 20;
const sum = { files: files.length, errors: 0, warnings: 0, triangles: 0, messages: [] };
for (const file of files) {
  const bytes = new Uint8Array(await readFile(file));
  // Files must be complete in themselves, so outside resources are an error.
  const report = await validator.validateBytes(bytes, {
    uri: file,
    maxIssues: 0,
    externalResourceFunction: (uri) => Promise.reject(new Error(`outside resource ${uri}`)),
  });
  sum.errors += report.issues.numErrors;
  sum.warnings += report.issues.numWarnings;
  sum.triangles += report.info?.totalTriangleCount ?? 0;
  for (const issue of report.issues.messages) {
    if (issue.severity <= 1 && sum.messages.length < kShown) {
      sum.messages.push(`${file}: ${kSeverities[issue.severity]} ${issue.code} at ${issue.pointer ?? issue.offset}: ${issue.message}`);
    }
  }
}
console.log(JSON.stringify(sum));
process.exit(sum.errors > 0 ? 1 : 0);
