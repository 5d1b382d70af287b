// Checks the source: node check.mjs. Types, lint and format, unit tests, sizes of what was built into dist. Each step prints its
// result, and all run even when one fails.
// The packages must be installed with those for development: npm ci --ignore-scripts
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

const root = path.dirname(fileURLToPath(import.meta.url));
const TSC = "node_modules/typescript/bin/tsc";
const BIOME = "node_modules/@biomejs/biome/bin/biome";
const STEPS = [
  ["types of the page", TSC, "-p", "tsconfig.json"],
  ["types of the rooms without a browser", TSC, "-p", "tsconfig.pure.json"],
  ["types of the tests", TSC, "-p", "tsconfig.test.json"],
  ["lint and format", BIOME, "check", "--error-on-warnings", "--max-diagnostics=50"],
  ["unit tests", "test/run_unit.mjs"],
  ["sizes of the bundles", "test/check_sizes.mjs", "dist"],
];

let failed = 0;
for (const [what, script, ...words] of STEPS) {
  const began = performance.now();
  let why = "";
  if (existsSync(path.join(root, script))) {
    const done = spawnSync(process.execPath, [script, ...words], { cwd: root, encoding: "utf8", maxBuffer: 1 << 26 });
    if (done.status !== 0)
      why = `${done.stdout}${done.stderr}${done.error ?? ""}`.trim() || `exit status ${done.status}`;
  } else {
    why = `${script} is missing: run 'npm ci --ignore-scripts' in ${root}`;
  }
  const seconds = ((performance.now() - began) / 1000).toFixed(1);
  if (why !== "") {
    failed += 1;
    console.log(why);
  }
  console.log(`${what}: ${why === "" ? "ok" : "FAILED"} (${seconds} s)`);
}
process.exitCode = failed === 0 ? 0 : 1;
