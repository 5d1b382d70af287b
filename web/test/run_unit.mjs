// Runs the unit tests: node test/run_unit.mjs [PART OF A PATH ...]. Node 18 runs no TypeScript, so each *.spec.ts is bundled first; packages stay
// outside. Runs in web/, where node_modules is.
import { spawnSync } from "node:child_process";
import { existsSync, readdirSync, rmSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "..");

function specs(folder) {
  if (!existsSync(folder)) return [];
  return readdirSync(folder, { withFileTypes: true })
    .flatMap((entry) => {
      const file = path.join(folder, entry.name);
      if (entry.isDirectory()) return specs(file);
      return /\.spec\.tsx?$/.test(entry.name) ? [file] : [];
    })
    .sort();
}

const filters = process.argv.slice(2);
const wanted = specs(path.join(root, "test")).filter(
  (file) => filters.length === 0 || filters.some((filter) => path.relative(root, file).includes(filter)),
);
if (wanted.length === 0) {
  console.error(
    `run_unit.mjs: no test ${filters.length === 0 ? "found" : `has "${filters.join('" or "')}" in its path`}`,
  );
  process.exit(1);
}
const esbuild = await import("esbuild").catch(() => {
  console.error(`run_unit.mjs: the packages are missing: run 'npm ci --ignore-scripts' in ${root} first`);
  process.exit(1);
});
// Inside node_modules, so that the bundles find the packages.
const out = path.join(root, "node_modules", ".cache", "skyquilt_unit", String(process.pid));
try {
  await esbuild.build({
    absWorkingDir: root,
    entryPoints: wanted,
    outbase: path.join(root, "test"),
    outdir: out,
    outExtension: { ".js": ".mjs" },
    bundle: true,
    packages: "external",
    platform: "node",
    format: "esm",
    target: "node18",
    jsx: "automatic",
    define: { SKYQUILT_TEST_HOOK: "true" },
    sourcemap: "inline",
    logLevel: "warning",
  });
  const bundles = wanted.map((file) =>
    path.join(out, path.relative(path.join(root, "test"), file).replace(/\.tsx?$/, ".mjs")),
  );
  const words = ["--enable-source-maps", "--test", "--test-reporter=spec", "--test-reporter-destination=stdout"];
  process.exitCode = spawnSync(process.execPath, [...words, ...bundles], { cwd: root, stdio: "inherit" }).status ?? 1;
} catch (error) {
  // esbuild has printed its own errors.
  if (!Array.isArray(error.errors)) console.error(error);
  process.exitCode = 1;
} finally {
  rmSync(out, { recursive: true, force: true });
}
