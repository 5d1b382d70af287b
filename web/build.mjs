// Bundles the front end: node build.mjs --out DIR [--test-hook]
// Writes the page of `skyquilt view` (index.html, app.js, app.css), that of exported tours (tour.html, tour.js, tour.css), licences.txt and
// manifest.json (sizes). The same source gives the same bytes.
import { mkdir, readdir, readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";

const root = path.dirname(fileURLToPath(import.meta.url));
/** Names of bundles and their pages: what `skyquilt view` serves, and what exported tours have as index.html. */
const PAGES = [
  ["app", "index.html"],
  ["tour", "tour.html"],
];
const ALLOWED = ["MIT", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "ISC"];

/** An error of the kind that needs no stack trace. */
class BuildError extends Error {}

function readArguments(words) {
  let out = null;
  let hook = false;
  for (let i = 0; i < words.length; i += 1) {
    if (words[i] === "--out" && i + 1 < words.length) {
      i += 1;
      out = path.resolve(words[i]);
    } else if (words[i] === "--test-hook") {
      hook = true;
    } else {
      throw new BuildError(`unknown argument ${words[i]}; use: node build.mjs --out DIR [--test-hook]`);
    }
  }
  if (out === null) throw new BuildError("--out is missing; use: node build.mjs --out DIR [--test-hook]");
  return { out, hook };
}

async function loadEsbuild() {
  try {
    return await import("esbuild");
  } catch (error) {
    if (error.code !== "ERR_MODULE_NOT_FOUND") throw error;
    throw new BuildError(`the packages are missing: run 'npm ci --ignore-scripts' in ${root} first`);
  }
}

const COMMON = {
  absWorkingDir: root,
  bundle: true,
  minify: true,
  target: "es2022",
  charset: "utf8",
  // They are in licences.txt, in full.
  legalComments: "none",
  logLevel: "warning",
  metafile: true,
  write: false,
};

async function bundle(esbuild, options) {
  try {
    const result = await esbuild.build({ ...COMMON, ...options });
    if (result.outputFiles.length !== 1) {
      const names = result.outputFiles.map((file) => path.basename(file.path)).join(", ");
      throw new BuildError(
        `${options.entryPoints[0]} became several files (${names}): styles belong into the style sheet beside it`,
      );
    }
    return { bytes: result.outputFiles[0].contents, metafile: result.metafile };
  } catch (error) {
    // esbuild has already printed what is wrong and where.
    if (Array.isArray(error.errors)) throw new BuildError(`${options.entryPoints[0]}: ${error.errors.length} error(s)`);
    throw error;
  }
}

/** The content security policy would block these silently, one by one, in the user's browser. */
function checkPage(name, html) {
  const forbidden = [
    [/<script(?![^>]*\ssrc=)[^>]*>/i, "a script without src"],
    [/<style/i, "a style element"],
    [/\sstyle\s*=/i, "a style attribute"],
    [/\son[a-z]+\s*=/i, "an event attribute"],
    [/(?:src|href)\s*=\s*["']?(?:https?:)?\/\//i, "an address of another host"],
  ];
  for (const [pattern, what] of forbidden) {
    if (pattern.test(html))
      throw new BuildError(`src/entry/${name} has ${what}, which the content security policy forbids`);
  }
}

/** Folders of the packages of which something is in one of the bundles. */
function packageFolders(metafiles) {
  const folders = new Set();
  for (const output of metafiles.flatMap(({ outputs }) => Object.values(outputs))) {
    for (const [input, { bytesInOutput }] of Object.entries(output.inputs)) {
      const at = input.lastIndexOf("node_modules/");
      if (at < 0 || bytesInOutput === 0) continue;
      const [scope, name] = input.slice(at + "node_modules/".length).split("/");
      folders.add(`${input.slice(0, at)}node_modules/${scope.startsWith("@") ? `${scope}/${name}` : scope}`);
      // Code of others inside a package has a licence of its own, which its package.json does not name.
      if (/\/(libs|vendor|third_party)\//.test(input.slice(at))) {
        throw new BuildError(`${input} is in the bundle: its licence is not known; do without it`);
      }
    }
  }
  return [...folders].sort();
}

async function readPackage(folder) {
  const { name, version, license } = JSON.parse(await readFile(path.join(root, folder, "package.json"), "utf8"));
  if (!ALLOWED.includes(license)) {
    throw new BuildError(
      `the licence of ${name} ${version} is ${license ?? "unknown"}; allowed: ${ALLOWED.join(", ")}`,
    );
  }
  const files = (await readdir(path.join(root, folder)))
    .filter((file) => /^(licen[cs]e|copying|notice)/i.test(file))
    .sort();
  if (!files.some((file) => !/^notice/i.test(file)))
    throw new BuildError(`${name} ${version} comes without the text of its licence`);
  const texts = await Promise.all(files.map((file) => readFile(path.join(root, folder, file), "utf8")));
  return { name, version, license, text: texts.map((text) => text.replaceAll("\r\n", "\n").trim()).join("\n\n") };
}

function licenceText(packages) {
  const intro = "The pages of `skyquilt view` and of exported tours contain code of these packages:\n\n";
  const list = packages.map(({ name, version, license }) => `  ${name} ${version} (${license})\n`).join("");
  const texts = packages.map(
    ({ name, version, license, text }) => `\n${"-".repeat(80)}\n${name} ${version} (${license})\n\n${text}\n`,
  );
  return intro + list + texts.join("");
}

async function main() {
  const { out, hook } = readArguments(process.argv.slice(2));
  const esbuild = await loadEsbuild();
  const files = {};
  const metafiles = [];
  for (const [name, html] of PAGES) {
    const script = await bundle(esbuild, {
      entryPoints: [`src/entry/${name}.tsx`],
      outfile: `${name}.js`,
      format: "iife",
      jsx: "automatic",
      define: { "process.env.NODE_ENV": '"production"', SKYQUILT_TEST_HOOK: hook ? "true" : "false" },
    });
    const style = await bundle(esbuild, { entryPoints: [`src/entry/${name}.css`], outfile: `${name}.css` });
    const page = await readFile(path.join(root, "src/entry", html), "utf8");
    checkPage(html, page);
    metafiles.push(script.metafile);
    files[`${name}.css`] = Buffer.from(style.bytes);
    files[`${name}.js`] = Buffer.from(script.bytes);
    files[html] = Buffer.from(page);
  }
  const packages = await Promise.all(packageFolders(metafiles).map(readPackage));
  files["licences.txt"] = Buffer.from(licenceText(packages));
  const manifest = {
    test_hook: hook,
    bytes: Object.fromEntries(Object.entries(files).map(([name, bytes]) => [name, bytes.length])),
    packages: packages.map(({ name, version, license }) => ({ name, version, licence: license })),
  };
  files["manifest.json"] = Buffer.from(`${JSON.stringify(manifest, null, 1)}\n`);
  await mkdir(out, { recursive: true });
  for (const [name, bytes] of Object.entries(files)) await writeFile(path.join(out, name), bytes);
  const sizes = PAGES.map(([name]) => `${name}.js ${Math.round(files[`${name}.js`].length / 1000)} kB`);
  console.log(`front end: ${sizes.join(", ")} in ${out}`);
}

try {
  await main();
} catch (error) {
  const missing = error.code === "ENOENT" ? `${error.path} is missing` : null;
  console.error(`build.mjs: ${error instanceof BuildError ? error.message : (missing ?? error.stack)}`);
  process.exitCode = 1;
}
